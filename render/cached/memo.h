#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace shadowcache {

/// Values by number, each made when it is first asked for. All are forgotten at once, at no cost.
template <class T>
class Memo {
public:
    /// Forgets all values, and takes numbers below `count`.
    void forget(std::size_t count) {
        if (values_.size() < count) {
            values_.resize(count);
            rounds_.resize(count, 0);
        }
        if (++round_ == 0) {
            std::ranges::fill(rounds_, 0u);
            round_ = 1;
        }
    }

    template <class Make>
    const T& at(std::size_t number, const Make& make) {
        if (rounds_[number] != round_) {
            rounds_[number] = round_;
            values_[number] = make();
        }
        return values_[number];
    }

private:
    std::vector<T> values_;
    std::vector<std::uint32_t> rounds_;  ///< in which a value was made
    std::uint32_t round_ = 0;
};

}  // namespace shadowcache
