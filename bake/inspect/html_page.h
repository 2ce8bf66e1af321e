#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/image/image.h"

namespace shadowcache {

/// Builds an HTML page that needs no other file; every tag is closed, as in XML.
class HtmlPage {
public:
    explicit HtmlPage(const std::string& title);

    void heading(const std::string& text);
    void paragraph(const std::string& text);
    void table(const std::vector<std::pair<std::string, std::string>>& rows);

    /// Bars side by side with their labels below, as SVG.
    void bars(const std::string& caption, const std::vector<std::string>& labels,
              const std::vector<std::uint64_t>& counts);

    /// A scale of the false colours, as SVG.
    void colorScale(const std::string& low, const std::string& high);

    /// Pictures in rows of three, as PNG inside the page.
    void pictures(const std::vector<std::pair<std::string, Image>>& pictures);

    /// The whole page.
    std::string text() const;

private:
    std::string body_;
    std::string title_;
};

}  // namespace shadowcache
