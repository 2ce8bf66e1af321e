#include "common/random/sequence.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "common/random/salts.h"

namespace shadowcache {
namespace {

/// Points are made in runs of 2^kRunBits with one common upper part of the index. Scrambling keeps
/// such a run together, so that its upper 32 - kRunBits matrix columns are added once a run, not
/// once a point.
constexpr int kRunBits = 6;
constexpr std::uint32_t kRun = 1u << kRunBits;

constexpr std::uint32_t reverseBits(std::uint32_t v) {
    v = (v >> 16) | (v << 16);
    v = ((v >> 8) & 0x00ff00ffu) | ((v & 0x00ff00ffu) << 8);
    v = ((v >> 4) & 0x0f0f0f0fu) | ((v & 0x0f0f0f0fu) << 4);
    v = ((v >> 2) & 0x33333333u) | ((v & 0x33333333u) << 2);
    return ((v >> 1) & 0x55555555u) | ((v & 0x55555555u) << 1);
}

/// Permutation in which a bit depends on itself and lower ones only: an Owen scrambling of the
/// bit-reversed word. [Burley 2020], with the constants and the multiplication by N. Vegdahl
/// (2021, "Building a Better LK Hash"), whose nodes are closer to independent.
constexpr std::uint32_t scrambleReversed(std::uint32_t v, std::uint32_t seed) {
    v ^= v * 0x3d20adeau;
    v += seed;
    v *= (seed >> 16) | 1u;
    v ^= v * 0x05526c56u;
    v ^= v * 0x53a22864u;
    return v;
}

using Matrix = std::array<std::uint32_t, 32>;

/// Column i is the bit-reversed word that bit 31 - i of the bit-reversed index adds.
/// [Joe & Kuo 2008, new-joe-kuo-6.21201: degree, coefficients and m of the first dimensions]
constexpr Matrix sobolMatrix(int dimension) {
    constexpr std::array<unsigned, kSobolDimensions> kDegree{0, 1, 2, 3};
    constexpr std::array<std::uint32_t, kSobolDimensions> kCoefficients{0, 0, 1, 1};
    constexpr std::array<std::array<std::uint32_t, 3>, kSobolDimensions> kInitial{
        {{}, {1, 0, 0}, {1, 3, 0}, {1, 3, 1}}};
    const unsigned degree = kDegree[dimension];
    Matrix v{};
    for (unsigned i = 0; i < 32; ++i) {
        if (degree == 0) {
            v[i] = 1u << (31 - i);
        } else if (i < degree) {
            v[i] = kInitial[dimension][i] << (31 - i);
        } else {
            v[i] = v[i - degree] ^ (v[i - degree] >> degree);
            for (unsigned k = 1; k < degree; ++k)
                v[i] ^= ((kCoefficients[dimension] >> (degree - 1 - k)) & 1u) * v[i - k];
        }
    }
    for (std::uint32_t& column : v) column = reverseBits(column);
    return v;
}

constexpr std::array<Matrix, kSobolDimensions> kMatrices{sobolMatrix(0), sobolMatrix(1),
                                                         sobolMatrix(2), sobolMatrix(3)};

constexpr std::array<std::uint32_t, kRun> kReversed = [] {
    std::array<std::uint32_t, kRun> reversed{};
    for (std::uint32_t i = 0; i < kRun; ++i) reversed[i] = reverseBits(i);
    return reversed;
}();

/// The columns of `matrix` from kRunBits up that the bit-reversed index selects, added.
std::uint32_t upperColumns(const Matrix& matrix, std::uint32_t reversedIndex) noexcept {
    std::uint32_t sum = 0;
    for (unsigned i = 0; i < 32; ++i) {
        const std::uint32_t column = i < kRunBits ? 0u : matrix[i];
        sum ^= (0u - ((reversedIndex >> (31 - i)) & 1u)) & column;
    }
    return sum;
}

}  // namespace

void owenSobol(std::uint32_t first, int dimension, std::uint64_t seed,
               std::span<std::uint32_t> out) noexcept {
    assert(dimension >= 0 && dimension < kSobolDimensions);
    const auto shuffleSeed = static_cast<std::uint32_t>(hashWords(seed));
    const std::uint64_t hash = hashWords(seed, RenderSalt::owenScramble + dimension);
    const auto scrambleSeed = static_cast<std::uint32_t>(hash);
    // The shift is a scrambling too; it makes every word uniform over the seeds whatever the hash
    // lacks.
    const auto shift = static_cast<std::uint32_t>(hash >> 32);
    const Matrix& matrix = kMatrices[static_cast<std::size_t>(dimension)];

    const std::size_t count = out.size();
    for (std::size_t done = 0; done < count;) {
        const std::uint32_t index = first + static_cast<std::uint32_t>(done);
        const std::uint32_t begin = index % kRun;
        const std::size_t lanes = std::min<std::size_t>(kRun - begin, count - done);
        const std::uint32_t base = reverseBits(index - begin);
        const std::uint32_t upper = upperColumns(matrix, scrambleReversed(base, shuffleSeed));
        const std::uint32_t* reversed = kReversed.data() + begin;
        std::uint32_t* words = out.data() + done;
        for (std::size_t i = 0; i < lanes; ++i) {
            const std::uint32_t shuffled = scrambleReversed(base | reversed[i], shuffleSeed);
            std::uint32_t word = upper;
            for (unsigned bit = 0; bit < kRunBits; ++bit)
                word ^= (0u - ((shuffled >> (31 - bit)) & 1u)) & matrix[bit];
            words[i] = reverseBits(scrambleReversed(word, scrambleSeed)) ^ shift;
        }
        done += lanes;
    }
}

void Sequence::fill(std::uint32_t first, int dimension, std::uint64_t seed,
                    std::span<std::uint32_t> out) const noexcept {
    if (words)
        words(*this, first, dimension, seed, out);
    else
        owenSobol(first, dimension, seed, out);
}

void randomWords(const Sequence&, std::uint32_t first, int dimension, std::uint64_t seed,
                 std::span<std::uint32_t> out) noexcept {
    for (std::size_t i = 0; i < out.size(); ++i)
        out[i] = static_cast<std::uint32_t>(
            hashWords(seed, RenderSalt::randomWord + dimension, first + i) >> 32);
}

}  // namespace shadowcache
