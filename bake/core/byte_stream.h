#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/base/error.h"

namespace shadowcache {

/// Values that are what their bytes are; Imath's vectors are, but they copy themselves by hand.
template <class T>
concept PlainBytes = std::is_standard_layout_v<T> && std::is_trivially_destructible_v<T>;

/// Appends values to a string of bytes, as this processor has them.
class ByteWriter {
public:
    template <PlainBytes T>
    void put(const T& value) {
        bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    template <PlainBytes T>
    void put(const std::vector<T>& values) {
        put(std::uint64_t{values.size()});
        bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    }
    void put(std::string_view text) {
        put(std::uint64_t{text.size()});
        bytes_.append(text);
    }
    std::string take() { return std::move(bytes_); }

private:
    std::string bytes_;
};

/// Takes values from the front of what a ByteWriter wrote. Each throws Error at its end.
class ByteReader {
public:
    explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

    template <PlainBytes T>
    T get() {
        T value;
        std::memcpy(static_cast<void*>(&value), next(sizeof value), sizeof value);
        return value;
    }
    template <PlainBytes T>
    std::vector<T> getVector() {
        const auto count = get<std::uint64_t>();
        if (count > bytes_.size() / sizeof(T)) fail();
        std::vector<T> values(count);
        if (count > 0)
            std::memcpy(static_cast<void*>(values.data()), next(count * sizeof(T)),
                        count * sizeof(T));
        return values;
    }
    std::string_view getText() {
        const auto count = get<std::uint64_t>();
        if (count > bytes_.size()) fail();
        return {next(count), count};
    }
    bool atEnd() const { return bytes_.empty(); }

private:
    const char* next(std::size_t count) {
        if (count > bytes_.size()) fail();
        const char* at = bytes_.data();
        bytes_.remove_prefix(count);
        return at;
    }
    [[noreturn]] static void fail() { throw Error("bytes of an earlier bake are cut short"); }

    std::string_view bytes_;
};

}  // namespace shadowcache
