#include "bake/inspect/html_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/image/false_color.h"
#include "common/image/png.h"
#include "common/image/srgb.h"

namespace shadowcache {

namespace {

constexpr const char* kStyle =
    "body{font:15px/1.5 sans-serif;color:#222;max-width:62em;margin:2em auto;padding:0 1em}"
    "h1{font-size:1.5em}h2{font-size:1.15em;margin-top:2em}"
    "table{border-collapse:collapse}td{padding:.1em 1.5em .1em 0;vertical-align:top}"
    "td:first-child{color:#666}figure{margin:1em 0}figcaption{color:#666;font-size:.9em}"
    ".row{display:grid;grid-template-columns:repeat(3,1fr);gap:1em;align-items:end}"
    ".row img{width:100%;image-rendering:pixelated;border:1px solid #ddd}"
    "svg text{font:11px sans-serif;fill:#444}";

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            default:
                // XML has no other control characters.
                if (static_cast<unsigned char>(c) >= 0x20 || c == '\n') out += c;
        }
    }
    return out;
}

std::string base64(const std::string& bytes) {
    static constexpr char kDigits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k)
            word =
                word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            out += i + k > bytes.size() ? '=' : kDigits[word >> (18 - 6 * k) & 63];
    }
    return out;
}

std::string hexColor(const Rgb& linear) {
    const auto byte = [](float value) {
        return static_cast<unsigned>(std::lround(255 * linearToSrgb(value)));
    };
    return fmt::format("#{:02x}{:02x}{:02x}", byte(linear.x), byte(linear.y), byte(linear.z));
}

}  // namespace

HtmlPage::HtmlPage(const std::string& title) : title_(escaped(title)) {}

void HtmlPage::heading(const std::string& text) {
    body_ += "<h2>" + escaped(text) + "</h2>\n";
}

void HtmlPage::paragraph(const std::string& text) {
    body_ += "<p>" + escaped(text) + "</p>\n";
}

void HtmlPage::table(const std::vector<std::pair<std::string, std::string>>& rows) {
    body_ += "<table>\n";
    for (const auto& [name, value] : rows)
        body_ += "<tr><td>" + escaped(name) + "</td><td>" + escaped(value) + "</td></tr>\n";
    body_ += "</table>\n";
}

void HtmlPage::bars(const std::string& caption, const std::vector<std::string>& labels,
                    const std::vector<std::uint64_t>& counts) {
    constexpr int kBar = 70, kHeight = 140;
    const int width = kBar * static_cast<int>(counts.size());
    std::uint64_t sum = 0;
    for (const std::uint64_t count : counts) sum += count;
    const std::uint64_t most = std::max<std::uint64_t>(1, *std::ranges::max_element(counts));
    body_ += fmt::format(
        "<figure><svg viewBox=\"0 0 {} {}\" width=\"{}\" style=\"max-width:100%\" role=\"img\">\n",
        width, kHeight + 40, width);
    for (std::size_t i = 0; i < counts.size(); ++i) {
        const int x = kBar * static_cast<int>(i);
        const int height =
            static_cast<int>(static_cast<double>(counts[i]) * kHeight / static_cast<double>(most));
        const int top = 16 + kHeight - height;
        const double percent = 100 * static_cast<double>(counts[i]) /
                               static_cast<double>(std::max<std::uint64_t>(1, sum));
        body_ += fmt::format(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"#2c718e\"/>"
            "<text text-anchor=\"middle\" x=\"{}\" y=\"{}\">{:.1f} %</text>"
            "<text text-anchor=\"middle\" x=\"{}\" y=\"{}\">{}</text>\n",
            x + 3, top, kBar - 6, height, x + kBar / 2, top - 4, percent, x + kBar / 2,
            kHeight + 32, escaped(labels[i]));
    }
    body_ += "</svg><figcaption>" + escaped(caption) + "</figcaption></figure>\n";
}

void HtmlPage::colorScale(const std::string& low, const std::string& high) {
    constexpr int kSteps = 40, kStep = 6;
    body_ +=
        fmt::format("<figure>{} <svg width=\"{}\" height=\"14\">", escaped(low), kSteps * kStep);
    for (int i = 0; i < kSteps; ++i)
        body_ += fmt::format("<rect x=\"{}\" y=\"0\" width=\"{}\" height=\"14\" fill=\"{}\"/>",
                             i * kStep, kStep + 1, hexColor(falseColor((i + 0.5) / kSteps)));
    body_ += "</svg> " + escaped(high) + "</figure>\n";
}

void HtmlPage::pictures(const std::vector<std::pair<std::string, Image>>& pictures) {
    body_ += "<div class=\"row\">\n";
    for (const auto& [caption, image] : pictures)
        body_ += "<figure><img alt=\"" + escaped(caption) + "\" src=\"data:image/png;base64," +
                 base64(encodePng(image, 0)) + "\"/><figcaption>" + escaped(caption) +
                 "</figcaption></figure>\n";
    body_ += "</div>\n";
}

std::string HtmlPage::text() const {
    return "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"/><title>" + title_ +
           "</title><style>" + kStyle + "</style></head>\n<body>\n<h1>" + title_ + "</h1>\n" +
           body_ + "</body>\n</html>\n";
}

}  // namespace shadowcache
