#include "common/cache/budgeted_pages.h"

#include <fmt/core.h>
#include <openvdb/points/StreamCompression.h>
#include <openvdb/util/NodeMasks.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "common/base/error.h"
#include "common/cache/leaf_view.h"

namespace shadowcache {

namespace {

/// More room than what is unpacked: OpenVDB packs less than 128 bytes as if they were so many, and
/// Blosc itself wants 16.
constexpr std::size_t kBloscRoom = 128;

/// Unpacks to the first `size` bytes of `out`, which has kBloscRoom more.
void unpackBlosc(std::span<const std::byte> packed, std::byte* out, std::size_t size) {
    // Blosc believes its 16 bytes of header, whose last four are the packed length.
    constexpr std::size_t kHeader = 16;
    std::uint32_t length = 0;
    if (packed.size() >= kHeader)
        std::memcpy(&length, packed.data() + kHeader - sizeof length, sizeof length);
    if (length < kHeader || length > packed.size()) OPENVDB_THROW(openvdb::IoError, "wrong length");
    openvdb::compression::bloscDecompress(reinterpret_cast<char*>(out), size, size + kBloscRoom,
                                          reinterpret_cast<const char*>(packed.data()));
}

/// A leaf after the other: its value mask, a length, and as many packed bytes; or, with the largest
/// length there is, the plain values.
void unpackVoxelEnds(std::span<const std::byte> packed, std::span<std::byte> out) {
    constexpr std::size_t kHead = sizeof(openvdb::util::NodeMask<3>) + sizeof(std::uint16_t);
    constexpr auto kPlain = std::numeric_limits<std::uint16_t>::max();
    const auto require = [&](std::size_t bytes) {
        if (packed.size() < bytes) OPENVDB_THROW(openvdb::IoError, "cut short");
    };
    std::vector<std::byte> unpacked(kVoxelEndBytes + kBloscRoom);
    for (; !out.empty(); out = out.subspan(kVoxelEndBytes)) {
        require(kHead);
        std::uint16_t length = 0;
        std::memcpy(&length, packed.data() + kHead - sizeof length, sizeof length);
        packed = packed.subspan(kHead);
        const std::size_t bytes = length == kPlain ? kVoxelEndBytes : length;
        require(bytes);
        if (length != kPlain) unpackBlosc(packed.first(length), unpacked.data(), kVoxelEndBytes);
        std::memcpy(out.data(), length == kPlain ? packed.data() : unpacked.data(), kVoxelEndBytes);
        packed = packed.subspan(bytes);
    }
}

}  // namespace

BudgetedPages::BudgetedPages(CheckedFile file, std::vector<FilePage> pages, std::uint64_t budget,
                             std::uint64_t overhead)
    : file_(std::move(file)), pages_(std::move(pages)), slots_(pages_.size()) {
    use_.budget = budget;
    use_.held = overhead + file_.pieces() * sizeof(std::uint64_t) +
                pages_.size() * (sizeof(FilePage) + sizeof(Slot));
    use_.peak = use_.held;
}

MemoryUse BudgetedPages::use() const {
    const std::lock_guard lock(mutex_);
    return use_;
}

/// Marks a page in memory as just used.
PagePin BudgetedPages::touch(std::uint32_t page) {
    Slot& slot = slots_[page];
    recent_.splice(recent_.begin(), recent_, slot.place);
    return slot.bytes;
}

bool BudgetedPages::pinHeld(std::span<const std::uint32_t> pages, std::span<PagePin> pins) {
    const std::lock_guard lock(mutex_);
    const auto held = [&](std::uint32_t page) { return slots_[page].bytes != nullptr; };
    if (!std::all_of(pages.begin(), pages.end(), held)) return false;
    for (std::size_t i = 0; i < pages.size(); ++i) pins[i] = touch(pages[i]);
    return true;
}

PagePin BudgetedPages::pin(std::uint32_t page) {
    std::unique_lock lock(mutex_);
    Slot& slot = slots_[page];
    loaded_.wait(lock, [&] { return !slot.loading; });
    if (slot.bytes) return touch(page);
    const FilePage& source = pages_[page];
    slot.loading = true;
    makeRoom(std::uint64_t{source.size} + source.stored);
    lock.unlock();
    PagePin bytes;
    try {
        bytes = load(source);
    } catch (...) {
        // Whoever waits for the page shall try, and fail, too.
        lock.lock();
        slot.loading = false;
        use_.held -= std::uint64_t{source.size} + source.stored;
        loaded_.notify_all();
        throw;
    }
    lock.lock();
    slot.loading = false;
    slot.bytes = bytes;
    slot.place = recent_.insert(recent_.begin(), page);
    use_.held -= source.stored;
    use_.bytesRead += source.stored;
    ++use_.loads;
    loaded_.notify_all();
    return bytes;
}

/// Drops pages that nobody holds, the longest unused first, until `bytes` more keep the budget;
/// then takes them.
void BudgetedPages::makeRoom(std::uint64_t bytes) {
    for (auto at = recent_.end(); at != recent_.begin() && use_.held + bytes > use_.budget;) {
        --at;
        Slot& slot = slots_[*at];
        // Only under the mutex does a page get one more holder than this.
        if (slot.bytes.use_count() > 1) continue;
        slot.bytes.reset();
        use_.held -= pages_[*at].size;
        ++use_.drops;
        at = recent_.erase(at);
    }
    use_.held += bytes;
    use_.peak = std::max(use_.peak, use_.held);
}

void BudgetedPages::readAt(std::uint64_t offset, std::span<std::byte> out) const {
    if (file_.read(offset, out) < out.size())
        throwFileError(file_.path(), "damaged: a page over the end of the file");
}

PagePin BudgetedPages::load(const FilePage& page) const {
    const auto bytes = std::make_shared_for_overwrite<std::byte[]>(page.size + kBloscRoom);
    if (page.kind == FilePage::Kind::plain) {
        readAt(page.offset, {bytes.get(), page.size});
        return bytes;
    }
    const auto packed = std::make_unique_for_overwrite<std::byte[]>(page.stored);
    readAt(page.offset, {packed.get(), page.stored});
    try {
        if (page.kind == FilePage::Kind::blosc)
            unpackBlosc({packed.get(), page.stored}, bytes.get(), page.size);
        else
            unpackVoxelEnds({packed.get(), page.stored}, {bytes.get(), page.size});
    } catch (const openvdb::Exception& e) {
        throwFileError(file_.path(),
                       fmt::format("damaged: the {} bytes at {} cannot be unpacked ({})",
                                   page.stored, page.offset, e.what()));
    }
    return bytes;
}

}  // namespace shadowcache
