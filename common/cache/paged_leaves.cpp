#include "common/cache/paged_leaves.h"

#include <algorithm>
#include <functional>

#include "common/base/error.h"
#include "common/cache/cache_grids.h"

namespace shadowcache {

namespace {

/// Voxels of the index are leaves.
openvdb::Coord leafOf(const openvdb::Coord& voxel) {
    return voxel >> PointLeaf::LOG2DIM;
}

void fillIndex(openvdb::Int32Tree& index, const PointLayout& leaves) {
    openvdb::tree::ValueAccessor<openvdb::Int32Tree> accessor(index);
    for (std::size_t i = 0; i < leaves.size(); ++i)
        accessor.setValue(leafOf(leaves[i].origin), static_cast<std::int32_t>(i));
}

template <class T>
const T* valuesAt(const PagePin& page, const ArrayPlace& place) {
    return reinterpret_cast<const T*>(page.get() + place.offset);
}

CountRows countsAt(const PagePin& page, const ArrayPlace& place, std::uint32_t stride) {
    const auto* values = valuesAt<std::uint8_t>(page, place);
    return place.uniform ? constantRows(*values) : CountRows{values, stride};
}

}  // namespace

PagedLeaves::PagedLeaves(const std::filesystem::path& path, const CacheHeader& header,
                         std::uint64_t budget)
    : path_(path),
      tiers_(header.tiers()),
      hits_(header.hits),
      emitters_(static_cast<std::uint32_t>(header.emitters.size())),
      emitterPlace_(emitterPlace(header)) {
    std::vector<FilePage> pages;
    CheckedFile file = openChecked(path);
    PointLayoutReader reader(file);
    const PointLayout items = reader.read(kItemGrid, itemAttributes(header), pages);
    blockLeaves_ = reader.read(kBlockGrid, blockAttributes(), pages);
    fillIndex(index_, items);
    openvdb::Int32Tree blockIndex(-1);
    fillIndex(blockIndex, blockLeaves_);
    leaves_.reserve(items.size());
    for (const LeafPlace& leaf : items) {
        leaves_.push_back({leaf, blockIndex.getValue(leafOf(leaf.origin)), items_});
        items_ += leaf.points;
    }
    for (const LeafPlace& leaf : blockLeaves_) blocks_ += leaf.points;
    const std::uint64_t overhead = leaves_.capacity() * sizeof(Leaf) +
                                   blockLeaves_.capacity() * sizeof(LeafPlace) + index_.memUsage();
    pages_ = std::make_unique<BudgetedPages>(std::move(file), std::move(pages), budget, overhead);
}

std::size_t PagedLeaves::leafWith(std::uint64_t item) const {
    const auto next = std::ranges::upper_bound(leaves_, item, std::less(), &Leaf::firstItem);
    return static_cast<std::size_t>(next - leaves_.begin()) - 1;
}

PagedLeaves::Reader::Reader(const PagedLeaves& leaves, bool hits)
    : leaves_(leaves),
      hitsPerItem_(hits ? static_cast<std::uint32_t>(leaves.hits_) : 0),
      emittersPerItem_(hits ? leaves.emitters_ : 0),
      attributes_(kHits + (hitsPerItem_ > 0 ? 1 : 0) + (emittersPerItem_ > 0 ? 1 : 0)),
      accessor_(leaves.index_) {}

const LeafView* PagedLeaves::Reader::find(const openvdb::Coord& voxel) {
    const std::int32_t leaf = accessor_.getValue(leafOf(voxel));
    if (leaf < 0) return nullptr;
    const auto found = std::find_if(slots_.begin(), slots_.end(),
                                    [&](const Slot& slot) { return slot.leaf == leaf; });
    Slot& slot =
        found != slots_.end()
            ? *found
            : *std::min_element(slots_.begin(), slots_.end(),
                                [](const Slot& a, const Slot& b) { return a.used < b.used; });
    if (found == slots_.end()) fill(slot, leaf);
    slot.used = now_;
    return &slot.view;
}

/// Lets go what this lookup has not used, so that it can be dropped.
void PagedLeaves::Reader::releaseOthers() {
    for (Slot& slot : slots_)
        if (slot.used != now_) slot = {};
}

void PagedLeaves::Reader::fill(Slot& slot, std::int32_t leaf) {
    slot = {};
    const Leaf& place = leaves_.leaves_[static_cast<std::size_t>(leaf)];
    const LeafPlace* blocks =
        place.blocks < 0 ? nullptr : &leaves_.blockLeaves_[static_cast<std::size_t>(place.blocks)];
    std::array<std::uint32_t, kPlaces> pages;
    std::size_t count = 0;
    pages[count++] = place.items.voxelEnds.page;
    for (std::size_t a = 0; a < attributes_; ++a) pages[count++] = place.items.arrays[a].page;
    for (std::size_t a = 0; blocks && a < kBlockAttributes; ++a)
        pages[count++] = blocks->arrays[a].page;
    const auto wanted = std::span(pages).first(count);
    if (!leaves_.pages_->pinHeld(wanted, slot.pins)) {
        releaseOthers();
        std::transform(wanted.begin(), wanted.end(), slot.pins.begin(),
                       [&](std::uint32_t page) { return leaves_.pages_->pin(page); });
    }

    const std::uint32_t baseCells = leaves_.tiers_.baseCells();
    const auto& item = place.items.arrays;
    const PagePin* pin = &slot.pins[1];
    LeafView& view = slot.view;
    view.voxelEnd = valuesAt<std::uint32_t>(slot.pins[0], place.items.voxelEnds);
    view.items = place.items.points;
    view.firstItem = place.firstItem;
    view.position = valuesAt<Vec3f>(pin[kPosition], item[kPosition]);
    view.normal = valuesAt<Vec3f>(pin[kNormal], item[kNormal]);
    view.n = countsAt(pin[kItemN], item[kItemN], baseCells);
    view.d = countsAt(pin[kItemD], item[kItemD], baseCells);
    view.patch = valuesAt<std::int16_t>(pin[kPatch], item[kPatch]);
    view.firstBlock = valuesAt<std::int32_t>(pin[kFirstBlock], item[kFirstBlock]);
    view.blockCount = valuesAt<std::int16_t>(pin[kBlockCount], item[kBlockCount]);
    if (hitsPerItem_ > 0) {
        view.hits = valuesAt<std::uint16_t>(pin[kHits], item[kHits]);
        view.hitsPerItem = hitsPerItem_;
    }
    if (emittersPerItem_ > 0) {
        const std::size_t at = leaves_.emitterPlace_;
        view.emitters = valuesAt<std::uint16_t>(pin[at], item[at]);
        view.emittersPerItem = emittersPerItem_;
    }
    if (blocks) {
        pin += attributes_;
        view.blocks = blocks->points;
        view.blockKeys = valuesAt<std::int16_t>(pin[kKey], blocks->arrays[kKey]);
        view.blockN = countsAt(pin[kBlockN], blocks->arrays[kBlockN], kBlockCells);
        view.blockD = countsAt(pin[kBlockD], blocks->arrays[kBlockD], kBlockCells);
    }
    requireSound(view, leaves_.tiers_, leaves_.path_);
    slot.leaf = leaf;
}

}  // namespace shadowcache
