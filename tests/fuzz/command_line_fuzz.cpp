// Command lines of shadowcache-bake or shadowcache-render, a word a line, or a settings file.

#include <unistd.h>

#if SHADOWCACHE_FUZZ_RENDER
#include "render/app/command_line.h"
#else
#include "bake/app/command_line.h"
#endif
#include "tests/fuzz/input_file.h"

namespace {

/// The words of a command line that the input is, or that names it as a settings file.
std::vector<std::string> wordsOf(const std::uint8_t* bytes, std::size_t size) {
    std::vector<std::string> words{"program"};
#if SHADOWCACHE_FUZZ_SETTINGS
    static shadowcache::fuzz::InputFile file("in.toml");
    words.insert(words.end(), {"set.obj", "-o", "set.vdb", "--config"});
    words.push_back(file.write({bytes, size}).string());
#else
    std::string word;
    for (std::size_t i = 0; i < size; ++i) {
        const char c = static_cast<char>(bytes[i]);
        if (c == '\n' || c == '\0')
            words.push_back(std::exchange(word, {}));
        else
            word += c;
    }
    words.push_back(word);
#endif
    return words;
}

#if SHADOWCACHE_FUZZ_RENDER
void parse(int argc, char** argv) {
    shadowcache::RenderJob job;
    shadowcache::parseArguments(argc, argv, job);
}
#else
void parse(int argc, char** argv) {
    shadowcache::BakeJob job;
    shadowcache::parseArguments(argc, argv, job);
}
#endif

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    // What --write-config writes goes nowhere else.
    static const shadowcache::test::TemporaryFolder folder;
    static const bool moved = chdir(folder.path().c_str()) == 0;
    shadowcache::fuzz::require(moved);
    std::vector<std::string> words = wordsOf(bytes, size);
    for (const std::string& word : words)
        if (word.find("write-config") != word.npos) return 0;
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    try {
        parse(static_cast<int>(arguments.size()), arguments.data());
    } catch (const shadowcache::Error&) {
    }
    return 0;
}
