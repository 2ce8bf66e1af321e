#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace shadowcache {

/// All that the items of a bake depend on: the set's content, the options, the program's version.
using BakeIdentity = std::vector<std::pair<std::string, std::string>>;

/// Finished regions of a bake, kept on the disk beside its output in a folder "OUTPUT.checkpoint"
/// until the bake is finished. Every run adds files of its own, under names that no other run has.
/// Thread-safe.
class Checkpoint {
public:
    /// What a region is of.
    enum class Pass : std::uint32_t { pilots = 1, items = 2 };

    /// @param interval  seconds between two files
    Checkpoint(const std::filesystem::path& output, BakeIdentity identity, double interval);

    /// Reads what earlier runs of this bake left.
    ///
    /// @return regions found
    /// @throws Error naming the folder and what differs, if it is of another bake
    std::size_t resume();

    /// Removes what ended runs on this machine left. @return number of files removed
    std::size_t discardOthers();

    /// Region `number` of a pass, once: what was read of it is forgotten.
    std::optional<std::string> take(Pass pass, std::size_t number);

    /// Adds a finished region, and writes a file if it is time for one. A full disk does not end
    /// the bake: what cannot be written stays in memory until it can.
    void add(Pass pass, std::size_t number, const std::string& bytes);

    /// Writes what is not yet written. @return whether all is on the disk
    bool flush();

    /// Removes this run's files and those that it read: the bake is finished.
    void remove();

    const std::filesystem::path& folder() const { return folder_; }
    /// Regions on the disk.
    std::size_t regions() const;

private:
    using Key = std::pair<std::uint32_t, std::uint64_t>;
    using Clock = std::chrono::steady_clock;

    void readFile(const std::filesystem::path& path);
    bool writePending(std::unique_lock<std::mutex>& lock);
    std::vector<std::filesystem::path> files() const;

    std::filesystem::path folder_;
    BakeIdentity identity_;
    Clock::duration interval_;

    mutable std::mutex mutex_;
    std::map<Key, std::string> found_;  ///< read, not yet taken
    std::string pending_;               ///< records to write
    std::size_t pendingRegions_ = 0, regions_ = 0;
    Clock::time_point due_;
    bool writing_ = false, warned_ = false;
    int number_ = 0;                               ///< of this run's next file
    std::vector<std::filesystem::path> obsolete_;  ///< once the bake is finished
};

}  // namespace shadowcache
