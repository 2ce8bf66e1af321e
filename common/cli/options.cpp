#include "common/cli/options.h"

#include <CLI/CLI.hpp>

namespace shadowcache {

namespace {

/// As --help and the completion for bash read it.
std::string typeOf(const OptionRow& row) {
    if (!row.type.empty()) return row.type;
    if (!row.choices.empty()) return "TEXT:{" + CLI::detail::join(row.choices) + "}";
    return row.form == OptionForm::whole    ? "INT"
           : row.form == OptionForm::number ? "FLOAT"
                                            : "TEXT";
}

/// The name, and the short one.
std::string namesOf(const OptionRow& row) {
    if (row.isPositional) return row.name;
    return (row.letter ? std::string("-") + row.letter + "," : "") + "--" + row.name;
}

void addRow(CLI::App& app, const OptionRow& row) {
    CLI::Option* option = nullptr;
    if (row.form == OptionForm::flag) {
        option = app.add_flag(namesOf(row), row.help);
    } else {
        option = app.add_option(namesOf(row), row.help)->type_name(typeOf(row));
        option->default_str(row.standard);
    }
    if (row.takesSeveral()) {
        option->take_all()->expected(1, CLI::detail::expected_max_vector_size);
        option->allow_extra_args(row.form == OptionForm::words || row.isPositional);
    }
    // Words of the program's own, which are no choices, may hold commas.
    if (row.form == OptionForm::words && !row.choices.empty()) option->delimiter(',');
    option->required(row.isRequired);
    option->configurable(row.isKept)->group(row.group);
}

/// The option of another row. CLI11 has no needs of one of two, which readRows() looks at.
void relate(CLI::App& app, const OptionRow& row) {
    CLI::Option* option = app.get_option(row.isPositional ? row.name : "--" + row.name);
    for (const std::string& name : CLI::detail::split(row.needs, ' '))
        if (!name.empty() && name.find('|') == name.npos) option->needs("--" + name);
    for (const std::string& name : CLI::detail::split(row.excludes, ' '))
        if (!name.empty()) option->excludes("--" + name);
}

}  // namespace

void addRows(CLI::App& app, std::span<const OptionRow> rows) {
    for (const OptionRow& row : rows) addRow(app, row);
    for (const OptionRow& row : rows) relate(app, row);
}

void readRows(const CLI::App& app, std::span<const OptionRow> rows) {
    std::vector<std::string> given;
    for (const OptionRow& row : rows) {
        const CLI::Option* option = app.get_option(row.isPositional ? row.name : "--" + row.name);
        if (option->count() == 0) continue;
        given.push_back(row.name);
        std::vector<std::string> texts = option->reduced_results();
        bool flag = false;
        if (row.form == OptionForm::flag && CLI::detail::lexical_cast(texts.back(), flag))
            texts = {flag ? "true" : "false"};
        row.read(texts);
    }
    requireTogether(rows, given);
}

}  // namespace shadowcache
