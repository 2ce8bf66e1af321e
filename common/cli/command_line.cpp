#include "common/cli/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <regex>

#include "common/base/atomic_file.h"
#include "common/base/exit_status.h"
#include "common/base/option_checks.h"
#include "common/base/progress.h"
#include "common/base/report_failure.h"
#include "common/base/suggestion.h"
#include "common/base/text_streams.h"
#include "common/base/version.h"
#include "common/cli/command_help.h"

namespace shadowcache {

namespace {

[[noreturn]] void refuseSettings(const std::string& cause) {
    throw CLI::ConfigError("settings file: " + cause);
}

/// CLI11 drops the last character of a list that the file does not close.
void requireClosedLists(const std::string& text) {
    TextReader lines(text);
    for (std::string line; std::getline(lines, line);) {
        const std::size_t equals = line.find('=');
        if (equals == line.npos) continue;
        const std::string name = CLI::detail::trim_copy(line.substr(0, equals));
        std::string value = CLI::detail::trim_copy(line.substr(equals + 1));
        if (!value.starts_with('[') || name.starts_with('#') || name.starts_with(';')) continue;
        for (std::string more; !value.ends_with(']');) {
            if (!std::getline(lines, more)) refuseSettings(name + ": expected ] at the list's end");
            value += CLI::detail::trim(more);
        }
    }
}

/// TOML without sections, whose contents CLI11 would ignore.
class SettingsFormat final : public CLI::ConfigTOML {
public:
    // "shot.####.exr" would end at the first #, quoted or not: comments have lines of their own.
    SettingsFormat() { comment(kNoText); }

    std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
        const std::string text(std::istreambuf_iterator<char>(input), {});
        if (text.find(kNoText) != text.npos) refuseSettings("a byte of value 1, expected text");
        requireClosedLists(text);
        TextReader checked(text);
        std::vector<CLI::ConfigItem> found = CLI::ConfigTOML::from_config(checked);
        for (const CLI::ConfigItem& item : found) {
            if (!item.parents.empty())
                refuseSettings("section [" + item.parents.front() + "], expected options only");
            if (item.inputs.empty()) refuseSettings(item.name + ": expected a value");
        }
        return found;
    }

private:
    static constexpr char kNoText = '\1';
};

void printAndEnd(const std::string& text) {
    std::fputs(text.c_str(), stdout);
    throw CLI::Success();
}

/// The first word of the command line or the settings file that is no option; empty if there is
/// none.
std::string unknownWord(const CLI::App& app, const CLI::ParseError& error) {
    const std::vector<std::string> left = app.remaining();
    for (const std::string& word : left)
        if (word.starts_with("-") && word.size() > 1) return word.substr(0, word.find('='));
    // Behind an unknown option its value may have been taken for something else.
    const bool extras = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
    return extras && !left.empty() ? left.front() : "";
}

/// The long option nearest to a mistyped one, with dashes if those were typed; empty if none is
/// near.
std::string meantOption(const CLI::App& app, const std::string& word) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options())
        for (const std::string& name : option->get_lnames())
            if (!option->get_group().empty()) names.push_back(name);
    const std::size_t dashes = std::min(word.find_first_not_of('-'), word.size());
    const std::string name = nearestWord(word.substr(dashes), names);
    return name.empty() ? "" : (dashes > 0 ? "--" : "") + name;
}

/// What stands between literals: of "A1B2" with {"A", "B", ""} it is {"1", "2"}; empty if the text
/// is not of that form. The first and the last literal begin and end the text. Texts hold what a
/// user typed, of any length: std::regex would overflow the stack.
std::vector<std::string> partsBetween(std::string_view text,
                                      const std::vector<std::string_view>& literals) {
    if (!text.starts_with(literals.front()) || !text.ends_with(literals.back())) return {};
    std::vector<std::string> parts;
    std::size_t at = literals.front().size();
    for (std::size_t i = 1; i < literals.size(); ++i) {
        const bool last = i + 1 == literals.size();
        const std::size_t end =
            last ? text.size() - literals[i].size() : text.find(literals[i], at);
        if (end == text.npos || end < at) return {};
        parts.emplace_back(text.substr(at, end - at));
        at = end + literals[i].size();
    }
    return parts;
}

/// CLI11's message in the form of ours: "--OPTION VALUE: expected ...".
std::string messageOf(const CLI::App& app, const CLI::ParseError& error) {
    const std::string text = error.what();
    const auto match = [&](const std::vector<std::string_view>& literals) {
        auto parts = partsBetween(text, literals);
        // The first is an option's name.
        if (!parts.empty() && parts[0].find(' ') != std::string::npos) parts.clear();
        return parts;
    };
    if (const auto m = match({"Could not convert: ", " = ", ""}); !m.empty()) {
        const CLI::Option* option = app.get_option_no_throw(m[0]);
        const bool whole = option && option->get_type_name().find("INT") != std::string::npos;
        return m[0] + " " + m[1].substr(m[1].rfind(',') + 1) + ": expected a " +
               (whole ? "whole " : "") + "number";
    }
    if (const auto m = match({"", ": ", " not in {", "}"}); !m.empty()) {
        std::vector<std::string> choices;
        std::string listed;
        TextReader list(m[2]);
        for (std::string choice; std::getline(list, choice, ',');) {
            listed += (listed.empty() ? "" : ", ") + choice;
            choices.push_back(choice);
        }
        return m[0] + " " + m[1] + ": expected one of " + listed +
               (m[1].size() > 1 ? suggestion(m[1], choices) : "");
    }
    if (const auto m = match({"--", ": ", ", expected ", ""}); !m.empty())
        return "--" + m[0] + " " + m[1] + ": expected " + m[2];
    if (const auto m = match({"", ": 1 required ", " missing"}); !m.empty())
        return m[0] + ": expected a value";
    if (const auto m = match({"", " excludes ", ""}); !m.empty())
        return m[0] + " cannot be combined with " + m[1];
    if (const auto m = partsBetween(text, {"", " was not readable (missing?)"}); !m.empty())
        return m[0] + ": cannot be read";
    return text;
}

int reportWrongUsage(const CLI::App& app, const CLI::ParseError& error) {
    const std::string word = unknownWord(app, error);
    const std::string meant = word.empty() ? "" : meantOption(app, word);
    const std::string cause =
        word.empty()
            ? messageOf(app, error)
            : word + ": no such option" + (meant.empty() ? "" : ", did you mean " + meant + "?");
    std::fprintf(stderr, "%s: %s\nRun with --help for more information.\n", app.get_name().c_str(),
                 oneLine(cause).c_str());
    return kWrongUsage;
}

/// CLI11 takes an empty value for 0, and for a path that was not given.
void requireValues(const CLI::App& app) {
    for (const CLI::Option* option : app.get_options())
        if (option->count() > 0)
            for (const std::string& value : option->results())
                if (value.empty())
                    throw CLI::ValidationError(option->get_name(), "expected a value");
}

}  // namespace

void beginCommandLine(CLI::App& app) {
    app.option_defaults()->take_last();
    app.set_version_flag("--version", app.get_name() + " " + kVersion);
    // Unknown keys of a settings file are treated like unknown options.
    app.allow_config_extras(CLI::config_extras_mode::capture);
    app.config_formatter(std::make_shared<SettingsFormat>());
}

void addSetOptions(CLI::App& app, std::vector<std::filesystem::path>& files, std::string& up,
                   double& scale, std::optional<int>& setFrame, bool& allowExternal,
                   const std::string& group) {
    app.add_option("SET", files,
                   "Geometry files (glTF, OBJ, PLY, STL, OFF, OM); several files form one set")
        ->required()
        ->take_all();
    app.add_option("--up", up, "Up axis of the files: y or z")
        ->check(CLI::IsMember({"y", "z"}))
        ->capture_default_str()
        ->group(group);
    app.add_option("--scale", scale, "Metres per unit of the files, above 0")
        ->capture_default_str()
        ->group(group);
    app.add_option(
           "--set-frame", setFrame,
           "Frame of glTF files in whose pose all of the set stands still [none: what moves "
           "is rendered in each frame and not baked]")
        ->group(group);
    app.add_flag("--allow-external", allowExternal,
                 "Let glTF and OBJ files name files outside of their folders")
        ->group(group);
}

void addThreadsOption(CLI::App& app, int& threads, const std::string& group) {
    app.add_option("--threads", threads, "Threads; 0: one per core")
        ->capture_default_str()
        ->group(group);
}

void addProgressOption(CLI::App& app, const std::string& group) {
    const auto choose = [](const std::string& name) {
        const auto& names = progressStyleNames();
        setProgressStyle(
            static_cast<ProgressStyle>(std::ranges::find(names, name) - names.begin()));
    };
    app.add_option_function<std::string>(
           "--progress", choose,
           "Progress on standard error: none, bar, lines (every ten seconds) or json (one object a "
           "second) [bar on a terminal, lines elsewhere]")
        ->check(CLI::IsMember(progressStyleNames()))
        ->group(group);
}

std::optional<int> parseCommandLine(CLI::App& app, int argc, char** argv,
                                    const std::function<void()>& check) {
    const std::string group = "Settings file";
    std::filesystem::path written;
    app.set_config("--config", "",
                   "Read options from a file (TOML); command-line options take precedence")
        ->type_name("TEXT")
        ->group(group);
    app.add_option("--write-config", written, "Write the options of this run to a file (.toml)")
        ->configurable(false)
        ->group(group);
    const auto addPrinter = [&app](const char* name, std::string (*text)(const CLI::App&)) {
        app.add_flag_callback(name, [&app, text] { printAndEnd(text(app)); })
            ->configurable(false)
            ->group("");
    };
    addPrinter("--man-page", manPage);
    addPrinter("--bash-completion", bashCompletion);
    try {
        app.parse(argc, argv);
        requireValues(app);
        check();
    } catch (const CLI::Success& e) {
        return app.exit(e);
    } catch (const CLI::ParseError& e) {
        return reportWrongUsage(app, e);
    }
    if (!written.empty()) {
        requireExtension(written, ".toml");
        // Only what was given: a default, read back, would count as given and may exclude another.
        writeWhole(written, app.config_to_str(false, false));
    }
    return std::nullopt;
}

std::array<int, 2> parsePair(const char* option, const std::string& text, const char* wanted) {
    static const std::regex pair(R"((\d{1,5})[x,](\d{1,5}))");
    std::smatch match;
    if (!std::regex_match(text, match, pair))
        throw Error(std::string(option) + " " + text + ": expected " + wanted);
    return {std::stoi(match[1]), std::stoi(match[2])};
}

std::uint64_t parseSize(const char* option, const std::string& text) {
    static const std::regex size(R"((\d{1,15}(?:\.\d{1,15})?)([KMGT]?)(?:i?B)?)",
                                 std::regex::icase);
    std::smatch match;
    double bytes = 0;
    if (std::regex_match(text, match, size)) {
        const std::string unit = match[2];
        const std::size_t power =
            unit.empty() ? 0 : 1 + std::string("KMGT").find(static_cast<char>(unit[0] & ~0x20));
        bytes = std::stod(match[1]) * std::pow(1024.0, static_cast<double>(power));
    }
    if (!(bytes >= 1 && bytes <= 0x1p62))
        throw Error(std::string(option) + " " + text +
                    ": expected a size in bytes, as in 4G, 1.5G or 512M");
    return static_cast<std::uint64_t>(bytes);
}

std::string notIn64Bits(const std::string& text) {
    if (text.starts_with("-")) return text + ", expected 0 or more";
    errno = 0;
    std::strtoull(text.c_str(), nullptr, 10);
    return errno == ERANGE ? text + ", expected below 2^64" : "";
}

std::vector<std::pair<std::string, std::string>> settingsOf(const CLI::App& app) {
    std::vector<std::pair<std::string, std::string>> settings;
    for (const CLI::Option* option : app.get_options()) {
        if (!option->get_configurable()) continue;
        std::string value = option->get_default_str();
        if (option->count() > 0) {
            value.clear();
            for (const std::string& part : option->reduced_results())
                value += (value.empty() ? "" : " ") + part;
        }
        if (!value.empty()) settings.emplace_back(option->get_single_name(), value);
    }
    return settings;
}

}  // namespace shadowcache
