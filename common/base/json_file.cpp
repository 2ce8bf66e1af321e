#include "common/base/json_file.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/base/atomic_file.h"

namespace shadowcache {

struct JsonFile::Impl {
    nlohmann::ordered_json root = nlohmann::ordered_json::object();

    nlohmann::ordered_json& at(std::string key) {
        std::replace(key.begin(), key.end(), '.', '/');
        return root[nlohmann::ordered_json::json_pointer("/" + key)];
    }
};

JsonFile::JsonFile() : impl_(std::make_unique<Impl>()) {}
JsonFile::~JsonFile() = default;

void JsonFile::set(const std::string& key, double value) {
    impl_->at(key) = value;
}
void JsonFile::set(const std::string& key, std::uint64_t value) {
    impl_->at(key) = value;
}
void JsonFile::set(const std::string& key, const std::string& value) {
    impl_->at(key) = value;
}
void JsonFile::set(const std::string& key, const std::vector<double>& values) {
    impl_->at(key) = values;
}
void JsonFile::set(const std::string& key, const std::vector<std::uint64_t>& values) {
    impl_->at(key) = values;
}

std::string JsonFile::text() const {
    // Strings may come from a damaged file.
    constexpr auto kReplaceBadText = nlohmann::ordered_json::error_handler_t::replace;
    return impl_->root.dump(2, ' ', false, kReplaceBadText) + "\n";
}

void JsonFile::write(const std::filesystem::path& path) const {
    writeWhole(path, text());
}

}  // namespace shadowcache
