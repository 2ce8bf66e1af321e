#include "common/cli/command_line.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>

#include "common/base/atomic_file.h"
#include "common/base/exit_status.h"
#include "common/base/option_checks.h"
#include "common/base/progress.h"
#include "common/base/report_failure.h"
#include "common/base/suggestion.h"
#include "common/base/text_streams.h"
#include "common/base/version.h"
#include "common/cli/command_help.h"
#include "common/cli/options.h"

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
        const std::string text = textOf(input);
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
    static constexpr std::size_t kMostBytes = std::size_t{16} << 20;

    /// All of it; of a device that has no end, too much.
    static std::string textOf(std::istream& input) {
        std::string text(kMostBytes, '\0');
        input.read(text.data(), static_cast<std::streamsize>(text.size()));
        if (input) refuseSettings("more than 16 MB, expected options");
        text.resize(static_cast<std::size_t>(input.gcount()));
        return text;
    }
};

/// Shows options of some groups, and of all where it is asked for all.
class ShortHelp final : public CLI::Formatter {
public:
    explicit ShortHelp(std::vector<std::string> groups) : groups_(std::move(groups)) {}

    std::string make_help(const CLI::App* app, std::string name,
                          CLI::AppFormatMode mode) const override {
        if (mode == CLI::AppFormatMode::All) return Formatter::make_help(app, name, mode);
        std::string text = make_description(app);
        text += make_usage(app, std::move(name));
        text += make_positionals(app);
        std::size_t others = 0;
        for (const std::string& group : app->get_groups()) {
            const auto options = app->get_options([&](const CLI::Option* option) {
                return option->get_group() == group && option->nonpositional();
            });
            if (group.empty() || options.empty()) continue;
            if (std::ranges::find(groups_, group) == groups_.end())
                others += options.size();
            else
                text += make_group(group, false, options) + "\n";
        }
        text += fmt::format("--help-all shows {} more options.\n\n", others);
        return text + make_footer(app);
    }

private:
    std::vector<std::string> groups_;
};

void printAndEnd(const std::string& text) {
    std::fputs(text.c_str(), stdout);
    throw CLI::Success();
}

template <class Kind>
bool isA(const CLI::ParseError& error) {
    return dynamic_cast<const Kind*>(&error) != nullptr;
}

/// The first word of the command line or the settings file that is no option; empty if there is
/// none.
std::string unknownWord(const CLI::App& app, const CLI::ParseError& error) {
    const std::vector<std::string> left = app.remaining();
    for (const std::string& word : left)
        if (word.starts_with("-") && word.size() > 1) return word.substr(0, word.find('='));
    // Behind an unknown option its value may have been taken for something else.
    return isA<CLI::ExtrasError>(error) && !left.empty() ? left.front() : "";
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

/// "--OPTION VALUE: expected a number" of the option whose value is none; empty if there is none.
std::string wrongNumber(CLI::App& app) {
    for (CLI::Option* option : app.get_options([](CLI::Option*) { return true; })) {
        if (option->count() == 0) continue;
        try {
            option->run_callback();
        } catch (const CLI::ConversionError&) {
            const bool flag = option->get_items_expected_max() == 0;
            const bool whole = option->get_type_name().find("INT") != std::string::npos;
            return option->get_name() + " " + option->results().back() + ": expected " +
                   (flag    ? "true or false"
                    : whole ? "a whole number"
                            : "a number");
        }
    }
    return "";
}

/// "--OPTION cannot be combined with --OTHER"; empty if no two options exclude each other.
std::string excluded(const CLI::App& app) {
    for (const CLI::Option* option : app.get_options())
        for (const CLI::Option* other : option->get_excludes())
            if (option->count() > 0 && other->count() > 0)
                return option->get_name() + " cannot be combined with " + other->get_name();
    return "";
}

/// The error in our form, where CLI11 says it in its own: "--OPTION VALUE: expected ...".
///
/// @param last  word of the command line
std::string messageOf(CLI::App& app, const CLI::ParseError& error, const std::string& last) {
    std::string text;
    if (isA<CLI::ConversionError>(error)) text = wrongNumber(app);
    if (isA<CLI::ExcludesError>(error)) text = excluded(app);
    if (isA<CLI::FileError>(error))
        text = app.get_config_ptr()->results().back() + ": cannot be read";
    if (isA<CLI::ArgumentMismatch>(error) && app.get_option_no_throw(last) != nullptr)
        text = last + ": expected a value";
    return text.empty() ? error.what() : text;
}

int reportWrongUsage(CLI::App& app, const CLI::ParseError& error, const std::string& last) {
    const std::string word = unknownWord(app, error);
    const std::string meant = word.empty() ? "" : meantOption(app, word);
    const std::string cause =
        word.empty()
            ? messageOf(app, error, last)
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

/// As CLI11 needs it before any option is defined.
void begin(CLI::App& app, const CommandLine& line) {
    app.option_defaults()->take_last();
    app.set_version_flag("--version", line.program + " " + kVersion);
    // Unknown keys of a settings file are treated like unknown options.
    app.allow_config_extras(CLI::config_extras_mode::capture);
    app.config_formatter(std::make_shared<SettingsFormat>());
    app.footer(line.footer);
    if (line.groupsInHelp.empty()) return;
    app.set_help_all_flag("--help-all", "Print all options and exit");
    app.formatter(std::make_shared<ShortHelp>(line.groupsInHelp));
}

void addFilesAndPrinters(CLI::App& app, std::filesystem::path& written,
                         std::span<const OptionRow> rows) {
    const std::string group = "Settings file";
    app.set_config("--config", "",
                   "Read options from a file (TOML); command-line options take precedence")
        ->type_name("TEXT")
        ->group(group);
    app.add_option("--write-config", written, "Write the options of this run to a file (.toml)")
        ->configurable(false)
        ->group(group);
    const auto addPrinter = [&app](const char* name, std::function<std::string()> text) {
        app.add_flag_callback(name, [text = std::move(text)] { printAndEnd(text()); })
            ->configurable(false)
            ->group("");
    };
    addPrinter("--man-page", [&app] { return manPage(app); });
    addPrinter("--bash-completion", [&app] { return bashCompletion(app); });
    addPrinter("--options", [rows] { return optionsAsJson(rows); });
}

std::vector<std::string> givenOptions(const CLI::App& app) {
    std::vector<std::string> given;
    for (const CLI::Option* option : app.get_options())
        if (option->count() > 0) given.push_back(option->get_name());
    return given;
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

}  // namespace

bool ParsedLine::isGiven(const std::string& option) const {
    return std::ranges::find(given, option) != given.end();
}

ParsedLine parseCommandLine(const CommandLine& line, int argc, char** argv,
                            std::span<const OptionRow> rows,
                            const std::function<void(const ParsedLine&)>& check) {
    if (findRow(rows, "progress")) setProgressStyle(standardProgressStyle());
    CLI::App app(line.summary, line.program);
    begin(app, line);
    addRows(app, rows);
    std::filesystem::path written;
    addFilesAndPrinters(app, written, rows);
    ParsedLine parsed;
    try {
        app.parse(argc, argv);
        requireValues(app);
        parsed.given = givenOptions(app);
        parsed.settings = settingsOf(app);
        readRows(app, rows);
        check(parsed);
    } catch (const CLI::Success& e) {
        parsed.status = app.exit(e);
    } catch (const CLI::ParseError& e) {
        parsed.status = reportWrongUsage(app, e, argv[argc - 1]);
    } catch (const FormError& e) {
        parsed.status = reportWrongUsage(app, CLI::ValidationError(e.what()), argv[argc - 1]);
    }
    if (parsed.status || written.empty()) return parsed;
    requireExtension(written, ".toml");
    // Only what was given: a default, read back, would count as given and may exclude another.
    writeWhole(written, app.config_to_str(false, false));
    return parsed;
}

}  // namespace shadowcache
