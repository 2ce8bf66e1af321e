// Large arrays ask for huge pages, which some kernels give only then. Paths of light read their
// arrays out of order: with pages of 4 kB they miss the processor's table of pages (TLB) often.

#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t kHugePage = std::size_t{1} << 21;

void* allocateHuge(std::size_t size) {
    void* block = std::aligned_alloc(kHugePage, (size + kHugePage - 1) / kHugePage * kHugePage);
    // The rest of the last page stays as it was. If the kernel refuses, pages are small.
    if (block) madvise(block, size / kHugePage * kHugePage, MADV_HUGEPAGE);
    return block;
}

}  // namespace

/// Allocates memory of the program, which the standard operator delete frees.
void* operator new(std::size_t size) {
    void* block = size >= kHugePage ? allocateHuge(size) : std::malloc(size > 0 ? size : 1);
    if (!block) throw std::bad_alloc();
    return block;
}
