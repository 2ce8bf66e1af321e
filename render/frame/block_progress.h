#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace shadowcache {

/// Tells how far a block of tiles is that take their time together, as if one were done after the
/// other. Thread-safe.
class BlockProgress {
public:
    /// Tells nobody.
    BlockProgress() = default;
    /// @param tiles    of the block, as far as they were asked for
    /// @param work     that the block takes, in any unit
    /// @param onTiles  is told of so many tiles more, by any thread
    BlockProgress(std::size_t tiles, std::size_t work, std::function<void(std::size_t)> onTiles);

    /// So much more of the work is done.
    void add(std::size_t work);
    /// All of it is.
    void finish();

private:
    std::size_t tilesAt(std::size_t work) const;

    std::size_t tiles_ = 0, work_ = 1;
    std::function<void(std::size_t)> onTiles_ = [](std::size_t) {};
    std::atomic<std::size_t> done_{0};
};

}  // namespace shadowcache
