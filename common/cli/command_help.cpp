#include "common/cli/command_help.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "common/base/text_streams.h"
#include "common/base/version.h"

namespace shadowcache {

namespace {

/// Text as roff shows it literally.
std::string roff(const std::string& text) {
    std::string out;
    TextReader lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (!out.empty()) out += "\n.br\n";
        if (line.starts_with(".") || line.starts_with("'")) out += "\\&";
        for (const char c : line) out += c == '\\' ? "\\e" : (c == '-' ? "\\-" : std::string(1, c));
    }
    return out;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + by.size()))
        text.replace(at, what.size(), by);
    return text;
}

std::vector<const CLI::Option*> optionsOf(const CLI::App& app, const std::string& group) {
    return app.get_options([&](const CLI::Option* option) {
        return option->get_group() == group && option->nonpositional();
    });
}

std::string entry(const CLI::Option& option, bool positional) {
    CLI::Formatter formatter;
    // Long lists of choices may break after a comma.
    const std::string type = replaced(roff(formatter.make_option_opts(&option)), ",", ",\\:");
    return ".TP\n\\fB" + roff(formatter.make_option_name(&option, positional)) + "\\fR" + type +
           "\n" + roff(option.get_description()) + "\n";
}

/// The choices that stand in the name of an option's type as {a,b}; empty if it has none.
std::string choicesOf(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    const std::size_t begin = type.find('{'), end = type.find('}', begin);
    if (begin == type.npos || end == type.npos) return "";
    return replaced(type.substr(begin + 1, end - begin - 1), ",", " ");
}

std::string namesOf(const CLI::Option& option, const char* between) {
    std::string names;
    for (const std::string& name : option.get_lnames())
        names += (names.empty() ? "--" : between + std::string("--")) + name;
    for (const std::string& name : option.get_snames())
        names += (names.empty() ? "-" : between + std::string("-")) + name;
    return names;
}

std::string jsonText(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += c == '\n' ? "\\n" : std::string(1, c);
    }
    return out + '"';
}

std::string listOf(const std::vector<std::string>& words) {
    std::string all;
    for (const std::string& word : words) all += (all.empty() ? "" : ", ") + jsonText(word);
    return "[" + all + "]";
}

/// A number that JSON can hold.
std::string numberOrNull(double number) {
    return std::isfinite(number) ? numberText(number) : "null";
}

constexpr Named<OptionForm> kForms[] = {
    {"flag", OptionForm::flag},     {"whole", OptionForm::whole},
    {"number", OptionForm::number}, {"numbers", OptionForm::numbers},
    {"fields", OptionForm::fields}, {"word", OptionForm::word},
    {"words", OptionForm::words},   {"text", OptionForm::text},
    {"texts", OptionForm::texts}};

std::string asJson(const OptionRow& row) {
    std::string form;
    for (const Named<OptionForm>& named : kForms)
        if (named.value == row.form) form = named.name;
    std::string line = "{\"name\": " + jsonText(row.name) + ", \"form\": " + jsonText(form);
    const std::pair<const char*, Door> doors[] = {
        {"serve", Door::serve}, {"python", Door::python}, {"blender", Door::blender}};
    for (const auto& [name, door] : doors)
        if (row.isAt(door))
            line += std::string(", \"") + name + "\": " + jsonText(row.nameAt(door));
    if (row.form == OptionForm::whole || row.form == OptionForm::number)
        line += ", \"range\": [" + numberOrNull(row.range.least) + ", " +
                numberOrNull(row.range.most) + "]";
    if (row.range.isLeastOut || row.range.isMostOut)
        line += std::string(", \"excluded\": \"") + (row.range.isMostOut ? "most" : "least") + "\"";
    if (!row.choices.empty()) line += ", \"choices\": " + listOf(row.choices);
    line += ", \"standard\": " + jsonText(row.standard);
    return line + ", \"help\": " + jsonText(row.help) + "}";
}

}  // namespace

std::string optionsAsJson(std::span<const OptionRow> rows) {
    std::string all;
    for (const OptionRow& row : rows) all += (all.empty() ? "[\n" : ",\n") + asJson(row);
    return all + "\n]\n";
}

std::string manPage(const CLI::App& app) {
    const std::string& name = app.get_name();
    std::string upper = name;
    std::transform(upper.begin(), upper.end(), upper.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    std::string page = ".TH " + upper + " 1 \"\" \"shadowcache " + kVersion +
                       "\" \"User Commands\"\n.ad l\n.SH NAME\n" + roff(name) + " \\- " +
                       roff(app.get_description()) + "\n.SH SYNOPSIS\n.B " + roff(name) +
                       "\n[OPTIONS]";
    const auto positionals =
        app.get_options([](const CLI::Option* option) { return option->get_positional(); });
    for (const CLI::Option* option : positionals)
        page += " " + roff(option->get_name(true)) +
                (option->get_items_expected_max() > 1 ? "..." : "");
    page += "\n.SH ARGUMENTS\n";
    for (const CLI::Option* option : positionals) page += entry(*option, true);
    page += ".SH OPTIONS\n";
    for (const std::string& group : app.get_groups()) {
        const auto options = optionsOf(app, group);
        if (group.empty() || options.empty()) continue;
        if (group != "Options") page += ".SS " + roff(group) + "\n";
        for (const CLI::Option* option : options) page += entry(*option, false);
    }
    page += ".SH NOTES\n.nf\n" + replaced(roff(app.get_footer()), "\n.br", "") +
            "\n.fi\n.SH SEE ALSO\n";
    for (const std::string other : {"bake", "farm", "info", "merge", "render"})
        if (name != "shadowcache-" + other) page += ".BR shadowcache\\-" + other + " (1)\n";
    return page;
}

std::string bashCompletion(const CLI::App& app) {
    std::string function = "_" + app.get_name(), choices, silent, all;
    std::replace(function.begin(), function.end(), '-', '_');
    for (const CLI::Option* option : app.get_options()) {
        if (!option->nonpositional() || option->get_group().empty()) continue;
        all += (all.empty() ? "" : " ") + namesOf(*option, " ");
        const std::string words = choicesOf(*option);
        const bool file = option->get_type_name().find("TEXT") != std::string::npos;
        if (!words.empty())
            choices += "        " + namesOf(*option, "|") +
                       ") mapfile -t COMPREPLY < <(compgen -W '" + words +
                       "' -- \"$word\"); return ;;\n";
        else if (option->get_items_expected_max() > 0 && !file)
            silent += (silent.empty() ? "" : "|") + namesOf(*option, "|");
    }
    if (!silent.empty()) choices += "        " + silent + ") return ;;\n";
    return "# Completion of " + app.get_name() + " " + kVersion + " for bash.\n" + function +
           "() {\n"
           "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}\n"
           "    COMPREPLY=()\n"
           "    case $before in\n" +
           choices +
           "    esac\n"
           "    if [[ $word == -* ]]; then\n"
           "        mapfile -t COMPREPLY < <(compgen -W '" +
           all +
           "' -- \"$word\")\n"
           "    else\n"
           "        mapfile -t COMPREPLY < <(compgen -f -- \"$word\")\n"
           "    fi\n"
           "}\n"
           "complete -o filenames -F " +
           function + " " + app.get_name() + "\n";
}

}  // namespace shadowcache
