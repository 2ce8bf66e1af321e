#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace shadowcache {

/// Objects that go from one chunk of a parallel loop to the next: what one has learned is kept, its
/// memory too. Thread-safe, but for forEach().
template <class T>
class Pool {
public:
    /// A free object, or what `make` makes: a std::unique_ptr<T>.
    template <class Make>
    std::unique_ptr<T> take(const Make& make) {
        {
            const std::lock_guard lock(mutex_);
            if (!free_.empty()) {
                std::unique_ptr<T> object = std::move(free_.back());
                free_.pop_back();
                return object;
            }
        }
        return make();
    }

    void giveBack(std::unique_ptr<T> object) {
        const std::lock_guard lock(mutex_);
        free_.push_back(std::move(object));
    }

    /// Visits the objects that are free.
    template <class Visit>
    void forEach(const Visit& visit) {
        for (const std::unique_ptr<T>& object : free_) visit(*object);
    }

private:
    std::mutex mutex_;
    std::vector<std::unique_ptr<T>> free_;
};

}  // namespace shadowcache
