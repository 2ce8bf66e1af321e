#include "common/base/option_row.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "common/base/suggestion.h"
#include "common/base/text_streams.h"

namespace shadowcache {

namespace {

[[noreturn]] void refuseForm(const std::string& name, const std::string& text,
                             const std::string& wanted) {
    throw FormError("--" + name + " " + text + ": expected " + wanted);
}

/// All of the text as a number. @throws FormError
template <class T>
T numberIn(const std::string& name, const std::string& text, const char* wanted) {
    const char* begin = text.data();
    const char* const end = begin + text.size();
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') ++begin;
    T number{};
    const auto [stop, error] = std::from_chars(begin, end, number);
    if (stop != end || begin == end || error == std::errc::invalid_argument)
        refuseForm(name, text, wanted);
    if (error == std::errc()) return number;
    if constexpr (std::is_floating_point_v<T>) {
        // Beyond the type's range, on one of its sides.
        const T huge = std::numeric_limits<T>::infinity();
        const bool isTiny = text.find_first_of("eE") != text.npos &&
                            text.find('-', text.find_first_of("eE")) != text.npos;
        return isTiny ? 0 : text[0] == '-' ? -huge : huge;
    }
    refuseForm(name, text, wanted);
}

void requireIn(const NumberRange& range, const std::string& name, double value,
               const std::string& text) {
    if (!range.contains(value))
        throw Error("--" + name + " " + text + ": expected " + range.text());
}

std::string listOf(const std::vector<std::string>& words) {
    std::string all;
    for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
    return all;
}

/// The place of a word among the choices. @throws FormError
std::size_t placeOf(const std::string& name, const std::string& word,
                    const std::vector<std::string>& choices) {
    const auto found = std::ranges::find(choices, word);
    if (found != choices.end()) return static_cast<std::size_t>(found - choices.begin());
    refuseForm(name, word,
               "one of " + listOf(choices) + (word.size() > 1 ? suggestion(word, choices) : ""));
}

OptionRow rowOf(std::string name, OptionForm form, std::string help) {
    OptionRow row;
    row.name = std::move(name);
    row.form = form;
    row.help = std::move(help);
    return row;
}

std::vector<std::string> wordsIn(const std::string& text) {
    std::vector<std::string> words;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find(' ', at), text.size());
        words.push_back(text.substr(at, end - at));
        at = end + 1;
    }
    return words;
}

bool isNameLetter(char c) {
    return c == '-' || std::islower(static_cast<unsigned char>(c)) ||
           std::isdigit(static_cast<unsigned char>(c));
}

}  // namespace

bool NumberRange::contains(double value) const {
    return std::isfinite(value) && value >= least && value <= most &&
           !(isLeastOut && value == least) && !(isMostOut && value == most);
}

std::string NumberRange::text() const {
    TextWriter text;
    if (std::isinf(most))
        text << "a number " << (isLeastOut ? "above " : "of at least ") << least;
    else
        text << least << " to " << (isMostOut ? "below " : "") << most;
    return text.str();
}

std::string OptionRow::nameAt(Door door) const {
    if (door == Door::commandLine) return name;
    const bool isPython = door == Door::python || door == Door::blender;
    std::string found = otherName.empty() ? name : otherName;
    if (door == Door::python && !pythonName.empty()) found = pythonName;
    if (isPython) std::ranges::replace(found, '-', '_');
    return found;
}

OptionRow& OptionRow::named(std::string elsewhere, std::string inPython) {
    otherName = std::move(elsewhere);
    pythonName = std::move(inPython);
    return *this;
}

OptionRow& OptionRow::needing(std::string names) {
    needs = std::move(names);
    return *this;
}

OptionRow& OptionRow::excluding(std::string names) {
    excludes = std::move(names);
    return *this;
}

OptionRow& OptionRow::typed(std::string text) {
    type = std::move(text);
    return *this;
}

OptionRow& OptionRow::onlyAt(std::initializer_list<Door> those) {
    doors = 0;
    for (const Door door : those) doors |= static_cast<unsigned>(door);
    return *this;
}

OptionRow& OptionRow::inBlender() {
    doors |= static_cast<unsigned>(Door::blender);
    return *this;
}

OptionRow& OptionRow::required() {
    isRequired = true;
    return *this;
}

OptionRow& OptionRow::notCompared() {
    isCompared = false;
    return *this;
}

OptionRow& OptionRow::notKept() {
    isKept = false;
    return *this;
}

OptionRow ownRow(std::string name, OptionForm form, std::function<void(const std::string&)> read,
                 std::string help) {
    OptionRow row = rowOf(std::move(name), form, std::move(help));
    row.read = [read = std::move(read)](std::span<const std::string> texts) { read(texts.back()); };
    return row;
}

OptionRow ownTextsRow(std::string name, std::function<void(std::span<const std::string>)> read,
                      std::string help) {
    OptionRow row = rowOf(std::move(name), OptionForm::texts, std::move(help));
    row.read = std::move(read);
    return row;
}

OptionRow flagRow(const std::string& name, bool& value, std::string help) {
    const auto read = [name, &value](const std::string& text) {
        if (text != "true" && text != "false") refuseForm(name, text, "true or false");
        value = text == "true";
    };
    return ownRow(name, OptionForm::flag, read, std::move(help));
}

OptionRow seedRow(const std::string& name, std::uint64_t& value, std::string help) {
    const auto read = [name, &value](const std::string& text) {
        value = numberIn<std::uint64_t>(name, text, "a whole number from 0 to below 2^64");
    };
    OptionRow row = ownRow(name, OptionForm::whole, read, std::move(help));
    row.range = {0, 0x1p64, false, true};
    row.standard = std::to_string(value);
    return row.typed("UINT");
}

OptionRow textRow(std::string name, std::string& value, std::string help) {
    OptionRow row = ownRow(
        std::move(name), OptionForm::text, [&value](const std::string& text) { value = text; },
        std::move(help));
    row.standard = value;
    return row;
}

OptionRow textRow(std::string name, std::filesystem::path& value, std::string help) {
    return ownRow(
        std::move(name), OptionForm::text, [&value](const std::string& text) { value = text; },
        std::move(help));
}

OptionRow wordsRow(const std::string& name, std::vector<std::string>& value,
                   std::vector<std::string> choices, std::string help) {
    OptionRow row = rowOf(name, OptionForm::words, std::move(help));
    row.choices = std::move(choices);
    row.read = [name, &value, choices = row.choices](std::span<const std::string> texts) {
        for (const std::string& word : texts) placeOf(name, word, choices);
        value.assign(texts.begin(), texts.end());
    };
    return row;
}

OptionRow option_row::whole(const std::string& name, std::function<void(std::int64_t)> put,
                            const NumberRange& range, std::string help) {
    const auto read = [name, put = std::move(put), range](const std::string& text) {
        const auto found = numberIn<std::int64_t>(name, text, "a whole number");
        requireIn(range, name, static_cast<double>(found), text);
        put(found);
    };
    OptionRow row = ownRow(name, OptionForm::whole, read, std::move(help));
    row.range = range;
    return row;
}

OptionRow option_row::number(const std::string& name, std::function<void(double)> put,
                             const NumberRange& range, std::string help) {
    const auto read = [name, put = std::move(put), range](const std::string& text) {
        const auto found = numberIn<double>(name, text, "a number");
        requireIn(range, name, found, text);
        put(found);
    };
    OptionRow row = ownRow(name, OptionForm::number, read, std::move(help));
    row.range = range;
    return row;
}

OptionRow option_row::word(const std::string& name, std::function<void(std::size_t)> put,
                           std::vector<std::string> choices, std::string help) {
    const auto read = [name, put = std::move(put), choices](const std::string& text) {
        put(placeOf(name, text, choices));
    };
    OptionRow row = ownRow(name, OptionForm::word, read, std::move(help));
    row.choices = std::move(choices);
    return row;
}

const OptionRow* findRow(std::span<const OptionRow> rows, const std::string& name) {
    const auto found = std::ranges::find(rows, name, &OptionRow::name);
    return found == rows.end() ? nullptr : &*found;
}

namespace {

/// @param names  joined by |; those that have no row do not count
void requireOneOf(std::span<const OptionRow> rows, const OptionRow& row, const std::string& names,
                  const std::function<bool(const std::string&)>& isGiven) {
    std::string wanted;
    TextReader all(names);
    for (std::string name; std::getline(all, name, '|');) {
        if (!findRow(rows, name)) continue;
        if (isGiven(name)) return;
        wanted += (wanted.empty() ? "--" : " or --") + name;
    }
    if (!wanted.empty()) throw FormError("--" + row.name + " requires " + wanted);
}

}  // namespace

void requireTogether(std::span<const OptionRow> rows, const std::vector<std::string>& given) {
    const auto isGiven = [&](const std::string& name) {
        return std::ranges::find(given, name) != given.end();
    };
    for (const OptionRow& row : rows) {
        if (!isGiven(row.name)) continue;
        for (const std::string& other : wordsIn(row.excludes))
            if (isGiven(other))
                throw FormError("--" + row.name + " cannot be combined with --" + other);
        for (const std::string& other : wordsIn(row.needs)) requireOneOf(rows, row, other, isGiven);
    }
}

std::string inWordsOf(Door door, std::span<const OptionRow> rows, const std::string& message) {
    if (door == Door::commandLine) return message;
    std::string told;
    for (std::size_t at = 0; at < message.size();) {
        const bool begins = (at == 0 || !isNameLetter(message[at - 1])) &&
                            std::string_view(message).substr(at).starts_with("--");
        std::size_t end = at + 2;
        while (begins && end < message.size() && isNameLetter(message[end])) ++end;
        const OptionRow* row =
            begins ? findRow(rows, message.substr(at + 2, end - at - 2)) : nullptr;
        if (!row) {
            told += message[at++];
            continue;
        }
        told += row->nameAt(door);
        if (row->form == OptionForm::flag && door == Door::python)
            told += row->isNegatedInPython ? "=False" : "=True";
        at = end;
    }
    return told;
}

}  // namespace shadowcache
