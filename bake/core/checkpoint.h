#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bake/core/bake_identity.h"

namespace shadowcache {

/// Finished regions of a bake, kept on the disk beside its output in a folder "OUTPUT.checkpoint"
/// until the bake is finished. Every run adds files of its own, under names that no other run has.
/// Thread-safe.
class Checkpoint {
public:
    /// Which results a region holds.
    enum class Pass : std::uint32_t { probes = 1, items = 2 };

    /// @param interval  seconds between two files
    /// @param memory    bytes of finished regions that may stay in memory, beside the file
    /// (mayKeep)
    Checkpoint(const std::filesystem::path& output, BakeIdentity identity, double interval,
               std::uint64_t memory = std::numeric_limits<std::uint64_t>::max());

    /// Finds the regions that earlier runs of this bake left.
    ///
    /// @return regions found
    /// @throws Error naming the folder and what differs, if it is of another bake
    std::size_t resume();

    /// Removes the files that ended runs on this machine left. @return number of files removed
    std::size_t discardOthers();

    /// Region `number` of a pass, if this run or one that it continues has added it. Nothing if its
    /// file is gone: another bake to the same output removes what it read once it is finished.
    std::optional<std::string> read(Pass pass, std::size_t number) const;

    /// All regions of a pass that are finished, in their order; puts them on the disk first. Where
    /// that is full, only those that it has.
    std::vector<std::string> finished(Pass pass);

    /// Whether a region of so many bytes may stay in memory. If not, it is read again later.
    bool mayKeep(std::uint64_t bytes);

    /// Adds a finished region, and writes a file if it is time for one. A full disk does not end
    /// the bake: regions stay in memory until they can be written.
    void add(Pass pass, std::size_t number, const std::string& bytes);

    /// Writes all regions that are not on the disk yet. @return whether all are
    bool flush();

    /// Removes this run's files and those that it read: the bake is finished.
    void remove();

    const std::filesystem::path& folder() const { return folder_; }
    /// Regions on the disk.
    std::size_t regions() const;

private:
    using Key = std::pair<std::uint32_t, std::uint64_t>;
    using Clock = std::chrono::steady_clock;

    /// Where a region's bytes are: in a file, or in `pending_`.
    struct Place {
        std::size_t file;  ///< of `files_`, or kPending
        std::size_t offset, size;
    };
    static constexpr std::size_t kPending = std::numeric_limits<std::size_t>::max();

    void readFile(const std::filesystem::path& path);
    bool writePending(std::unique_lock<std::mutex>& lock);
    std::vector<std::filesystem::path> filesFound() const;

    std::filesystem::path folder_;
    BakeIdentity identity_;
    Clock::duration interval_;

    mutable std::mutex mutex_;
    mutable std::condition_variable written_;  ///< writing_ has become false
    std::map<Key, Place> places_;
    std::string pending_;              ///< records to write
    std::vector<Key> pendingRegions_;  ///< of them, in their order
    std::uint64_t memory_, kept_ = 0;
    std::size_t regions_ = 0;
    Clock::time_point due_;
    bool writing_ = false, warned_ = false;
    int number_ = 0;                            ///< of this run's next file
    std::vector<std::filesystem::path> files_;  ///< read and written, removed in the end
};

}  // namespace shadowcache
