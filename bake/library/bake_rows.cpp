#include "bake/library/bake_rows.h"

#include <string_view>

#include "common/base/option_text.h"
#include "common/base/take_text.h"
#include "common/cache/cache_items.h"

namespace shadowcache {

namespace {

constexpr Named<BakeQuality> kQualities[] = {
    {"draft", BakeQuality::draft}, {"good", BakeQuality::good}, {"fine", BakeQuality::fine}};

/// Metres, or "2x": times the spacing that is chosen.
OptionRow spacingRow(double& spacing, std::optional<double>& chosenSpacings) {
    const auto read = [&](const std::string& text) {
        std::string_view rest = text;
        double number = 0;
        if (!takeNumber(rest, number) || (!rest.empty() && rest != "x"))
            refuseText("spacing", text, "metres, or times the spacing that is chosen, as in 2x");
        if (rest.empty())
            spacing = number;
        else
            chosenSpacings = number;
    };
    OptionRow row =
        ownRow("spacing", OptionForm::number, read,
               "Voxel size in metres; smaller is sharper, at a cost of the inverse square. 2x: "
               "twice the one for the set's size [chosen from the set's size and, for a shot, "
               "coarser if its pictures are few or small]");
    row.range = {0, kMostSpacing};
    return row.typed("METRES");
}

/// "K/N": shard K - 1 of N.
OptionRow shardRow(BakeOptions& bake) {
    const auto read = [&bake](const std::string& text) {
        std::string_view rest = text;
        int part = 0, parts = 0;
        if (!takeNumber(rest, part) || !takeCharacter(rest, '/') || !takeNumber(rest, parts) ||
            !rest.empty() || part < 0 || parts < 0)
            refuseText("shard", text, "K/N, as in 2/8");
        bake.shard = part - 1;
        bake.shards = parts;
    };
    return ownRow("shard", OptionForm::text, read,
                  "Bake part K of N of the set; shadowcache-merge joins the parts")
        .onlyAt({Door::commandLine});
}

/// A flag that takes something away.
OptionRow withoutRow(std::string name, bool& value, std::string help) {
    return ownRow(
        std::move(name), OptionForm::flag,
        [&value](const std::string& text) { value = text != "true"; }, std::move(help));
}

}  // namespace

OptionRow marginRow(int& margin) {
    return wholeRow("margin", margin, 0, 64,
                    "Voxels to bake around those that are looked up, 0 to 64, for cameras that may "
                    "still move");
}

std::vector<OptionRow> bakeRows(BakeOptions& bake, std::optional<double>& chosenSpacings) {
    OptionRow transport =
        withoutRow("no-transport", bake.transport,
                   "Leave out which items the rays of each item met, which bounced light uses");
    transport.isNegatedInPython = true;
    OptionRow lamps =
        withoutRow("no-lamps", bake.lamps,
                   "Leave out what the items see of the set's own lamps, whatever these emit");
    lamps.isNegatedInPython = true;
    return {
        spacingRow(bake.spacing, chosenSpacings),
        wordRow("quality", bake.quality, kQualities,
                "Of the spacing that is chosen. good: the least time for bake and pictures "
                "together; draft, fine: an eighth of its rays, eight times as many")
            .excluding("spacing extend"),
        wholeRow(
            "level", bake.level, 0, kMaxCacheLevel,
            "Finest direction level, 0 to 5: 20 * 4^level regions over the sphere; 4 for a shot "
            "whose pictures are few or small"),
        wholeRow("rays", bake.rays, 1, 255, "Rays per region of mixed visibility, 1 to 255"),
        withoutRow("uniform", bake.adaptive,
                   "Refine every region to the finest level, not only where visibility is "
                   "mixed"),
        transport.named("", "transport"),
        lamps.named("", "lamps"),
        seedRow("seed", bake.seed,
                "Random seed; caches of different seeds merge into a better one"),
        shardRow(bake)};
}

}  // namespace shadowcache
