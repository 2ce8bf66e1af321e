#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/image/image.h"

namespace shadowcache {

/// Builds an HTML page that needs no other file; every tag is closed, as in XML. All texts are
/// plain: what is markup in HTML is escaped.
class HtmlPage {
public:
    explicit HtmlPage(const std::string& title);

    /// Adds a heading of the second level.
    void heading(const std::string& text);
    /// Adds a paragraph.
    void paragraph(const std::string& text);
    /// Adds a table of two columns.
    void table(const std::vector<std::pair<std::string, std::string>>& rows);

    /// Adds bars side by side with their labels below, as SVG; as many labels as counts.
    void bars(const std::string& caption, const std::vector<std::string>& labels,
              const std::vector<std::uint64_t>& counts);

    /// Adds a scale of the false colours with the labels of its ends, as SVG.
    void colorScale(const std::string& low, const std::string& high);

    /// Adds captioned pictures in rows of three, as PNG inside the page.
    void pictures(const std::vector<std::pair<std::string, Image>>& pictures);

    /// The whole page.
    std::string text() const;

private:
    std::string body_;
    std::string title_;
};

}  // namespace shadowcache
