#include "bake/core/checkpoint.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "bake/core/byte_stream.h"
#include "common/base/atomic_file.h"
#include "common/base/content_hash.h"
#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/base/leftovers.h"

namespace shadowcache {

namespace {

namespace fs = std::filesystem;

/// A file is this, the identity, records (pass, region, bytes), and a checksum of all before it.
constexpr std::string_view kMagic = "Shadowcache checkpoint 2\n";
constexpr const char* kExtension = ".regions";

/// "RUN.NUMBER.regions" -> RUN.
std::string runOf(const fs::path& path) {
    return path.stem().stem().string();
}

}  // namespace

Checkpoint::Checkpoint(const fs::path& output, BakeIdentity identity, double interval,
                       std::uint64_t memory)
    : folder_(output.string() + ".checkpoint"),
      identity_(std::move(identity)),
      interval_(
          std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(interval))),
      memory_(memory),
      due_(Clock::now() + interval_) {}

/// Files with regions, in order; what an ended run did not finish writing is removed.
std::vector<fs::path> Checkpoint::filesFound() const {
    std::vector<fs::path> found, unfinished;
    std::error_code error;
    fs::directory_iterator entry(folder_, error);
    for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
        const fs::path& path = entry->path();
        if (path.extension() == kExtension)
            found.push_back(path);
        else if (const auto end = path.string().find(kTemporaryMark); end != std::string::npos)
            unfinished.emplace_back(path.string().substr(0, end));
    }
    std::vector<Leftover> kept;
    for (const fs::path& path : unfinished) removeLeftovers(path, kept);
    std::ranges::sort(found);
    return found;
}

std::size_t Checkpoint::resume() {
    for (const fs::path& path : filesFound()) {
        files_.push_back(path);
        readFile(path);
    }
    const std::lock_guard lock(mutex_);
    regions_ = places_.size();
    return regions_;
}

void Checkpoint::readFile(const fs::path& path) {
    const std::string bytes = readFileBytes(path);
    const auto content = unsealed(bytes);
    if (!content || !content->starts_with(kMagic)) {
        std::printf("%s: damaged, what it holds is baked again\n", path.c_str());
        return;
    }
    ByteReader in(content->substr(kMagic.size()));
    const std::string other = differences(getIdentity(in), identity_);
    if (!other.empty())
        throwFileError(folder_, "checkpoint of another bake: " + other +
                                    " (bake without --resume to drop it)");
    const std::lock_guard lock(mutex_);
    while (!in.atEnd()) {
        const auto pass = in.get<std::uint32_t>();
        const auto number = in.get<std::uint64_t>();
        const std::string_view region = in.getText();
        const auto offset = static_cast<std::size_t>(region.data() - bytes.data());
        places_[{pass, number}] = {files_.size() - 1, offset, region.size()};
    }
}

std::size_t Checkpoint::discardOthers() {
    std::size_t removed = 0;
    std::error_code ignored;
    for (const fs::path& path : filesFound())
        if (!mayBeAlive(runOf(path)) && fs::remove(path, ignored)) ++removed;
    fs::remove(folder_, ignored);  // if nothing is left in it
    return removed;
}

std::optional<std::string> Checkpoint::read(Pass pass, std::size_t number) const {
    std::unique_lock lock(mutex_);
    const auto found = places_.find({static_cast<std::uint32_t>(pass), number});
    if (found == places_.end()) return std::nullopt;
    const Place& place = found->second;
    // What is being written is neither in memory nor in the file.
    if (place.file == kPending) written_.wait(lock, [this] { return !writing_; });
    if (place.file == kPending) return pending_.substr(place.offset, place.size);
    std::string bytes(place.size, '\0');
    std::ifstream file(files_[place.file], std::ios::binary);
    file.seekg(static_cast<std::streamoff>(place.offset));
    if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) return std::nullopt;
    return bytes;
}

std::vector<std::string> Checkpoint::finished(Pass pass) {
    flush();
    std::vector<std::size_t> numbers;
    {
        const std::lock_guard lock(mutex_);
        const auto wanted = static_cast<std::uint32_t>(pass);
        for (auto at = places_.lower_bound({wanted, 0});
             at != places_.end() && at->first.first == wanted; ++at)
            if (at->second.file != kPending) numbers.push_back(at->first.second);
    }
    std::vector<std::string> regions;
    for (const std::size_t number : numbers)
        if (auto bytes = read(pass, number)) regions.push_back(std::move(*bytes));
    return regions;
}

bool Checkpoint::mayKeep(std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    if (bytes > memory_ - kept_) return false;
    kept_ += bytes;
    return true;
}

void Checkpoint::add(Pass pass, std::size_t number, const std::string& bytes) {
    const Key key{static_cast<std::uint32_t>(pass), number};
    ByteWriter record;
    record.put(key.first);
    record.put(key.second);
    record.put(std::string_view(bytes));
    std::unique_lock lock(mutex_);
    pending_ += record.take();
    places_[key] = {kPending, pending_.size() - bytes.size(), bytes.size()};
    pendingRegions_.push_back(key);
    const bool due = Clock::now() >= due_ || pending_.size() > memory_ / 4;
    if (!writing_ && due) writePending(lock);
}

bool Checkpoint::flush() {
    std::unique_lock lock(mutex_);
    written_.wait(lock, [this] { return !writing_; });
    return pendingRegions_.empty() || writePending(lock);
}

/// Other threads go on while one writes.
bool Checkpoint::writePending(std::unique_lock<std::mutex>& lock) {
    writing_ = true;
    std::string records = std::move(pending_);
    pending_.clear();
    std::vector<Key> regions = std::exchange(pendingRegions_, {});
    lock.unlock();
    fs::path path;
    std::string cause;
    std::size_t start = 0;  // of the records in the file
    try {
        // An ended run may have had this process's number.
        do path = folder_ / fmt::format("{}.{}{}", runName(), number_++, kExtension);
        while (fs::exists(path));
        ByteWriter head;
        put(head, identity_);
        std::string content = std::string(kMagic) + head.take();
        start = content.size();
        content += records;
        content = sealed(std::move(content));
        std::error_code ignored;
        if (fs::create_directory(folder_, ignored))
            syncFolder(folder_.has_parent_path() ? folder_.parent_path() : ".");
        AtomicFile file(path);
        file.write(content.data(), content.size());
        file.commit();
    } catch (const std::exception& e) {
        cause = e.what();
    }
    lock.lock();
    writing_ = false;
    written_.notify_all();
    due_ = Clock::now() + interval_;
    if (cause.empty()) {
        regions_ += regions.size();
        for (const Key& key : regions) {
            Place& place = places_[key];
            place = {files_.size(), start + place.offset, place.size};
        }
        files_.push_back(path);
        return true;
    }
    for (const Key& key : pendingRegions_) places_[key].offset += records.size();
    pending_ = std::move(records) + pending_;
    pendingRegions_.insert(pendingRegions_.begin(), regions.begin(), regions.end());
    if (!std::exchange(warned_, true))
        std::fprintf(stderr, "warning: no checkpoint: %s\n", cause.c_str());
    return false;
}

void Checkpoint::remove() {
    const std::lock_guard lock(mutex_);
    std::error_code ignored;
    for (const fs::path& path : files_) fs::remove(path, ignored);
    fs::remove(folder_, ignored);  // unless another run still has files in it
}

std::size_t Checkpoint::regions() const {
    const std::lock_guard lock(mutex_);
    return regions_;
}

}  // namespace shadowcache
