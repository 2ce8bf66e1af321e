#include "common/farm/plan.h"

#include <fmt/core.h>

#include <algorithm>

#include "common/base/option_checks.h"

namespace shadowcache {

namespace {

std::vector<FarmWord> wordsOf(const std::vector<std::string>& texts) {
    std::vector<FarmWord> words;
    words.reserve(texts.size());
    for (const std::string& text : texts) words.push_back({text});
    return words;
}

void append(std::vector<FarmWord>& words, const std::vector<FarmWord>& more) {
    words.insert(words.end(), more.begin(), more.end());
}

/// The plan of a job, step by step.
class Planner {
public:
    Planner(const FarmJob& job, FarmPlan place)
        : job_(job), plan_(std::move(place)), frames_(framesText(job.frames)) {
        plan_.steps.clear();
    }

    FarmPlan plan() {
        if (job_.shards == 1) {
            bake({cache()});
        } else {
            lookUp();
            bake({in("parts/"), true, ".vdb"});
            merge();
        }
        render();
        check();
        return plan_;
    }

private:
    std::string in(const std::string& name) const { return (plan_.folder / name).string(); }
    std::string cache() const { return in("cache.vdb"); }
    std::string lookups() const { return in("shot.lookups"); }

    /// Options that only say how a task runs.
    std::vector<FarmWord> running() const {
        return wordsOf({"--threads", std::to_string(plan_.threads), "--progress", "lines"});
    }

    /// A step of the bake for all frames.
    FarmStep baking(const std::string& name, const FarmWord& output) const {
        FarmStep step{name, "shadowcache-bake", wordsOf(job_.set), {}, output, job_.sources};
        append(step.arguments, wordsOf(job_.bakeOnly));
        append(step.arguments, wordsOf({"--frames", frames_}));
        return step;
    }

    /// What the shot looks up is the same for all shards: found once.
    void lookUp() {
        FarmStep step = baking("lookup", {lookups()});
        append(step.arguments, wordsOf({"--lookups-only", "-o", lookups()}));
        append(step.arguments, running());
        step.values = {"1"};
        plan_.steps.push_back(std::move(step));
    }

    void bake(const FarmWord& output) {
        FarmStep step = baking("bake", output);
        if (job_.shards > 1)
            append(step.arguments, {{"--lookups"},
                                    {lookups()},
                                    {"--shard"},
                                    {"", true, fmt::format("/{}", job_.shards)}});
        if (job_.shards > 1) step.sources.emplace_back(lookups());
        append(step.arguments, {{"-o"}, output, {"--resume"}});
        append(step.arguments, running());
        for (int i = 1; i <= job_.shards; ++i) step.values.push_back(std::to_string(i));
        plan_.steps.push_back(std::move(step));
    }

    void merge() {
        FarmStep step{"merge", "shadowcache-merge", {}, {"1"}, {cache()}, {in("parts")}};
        const FarmStep& bakes = plan_.steps.back();
        for (const std::string& value : bakes.values)
            step.arguments.push_back({bakes.product.with(value)});
        append(step.arguments, wordsOf({"-o", cache(), "--progress", "lines"}));
        plan_.steps.push_back(std::move(step));
    }

    /// A step of the renderer, for the frames that `frames` has.
    FarmStep rendering(const std::string& name, const FarmWord& frames) const {
        FarmStep step{name, "shadowcache-render", wordsOf(job_.set), {}, {}, {}};
        append(step.arguments, wordsOf(job_.renderOnly));
        const std::string pictures =
            job_.pictures.empty() ? in("frames/frame.####.exr") : job_.pictures;
        append(step.arguments, {{"--cache"}, {cache()}, {"--frames"}, frames, {"-o"}, {pictures}});
        return step;
    }

    void render() {
        FarmStep step = rendering("render", {"", true, ""});
        append(step.arguments, wordsOf({"--shot-frames", frames_}));
        append(step.arguments, {{"--resume"}});
        append(step.arguments, running());
        const auto chunk = static_cast<std::ptrdiff_t>(job_.chunk);
        for (auto at = job_.frames.begin(); at != job_.frames.end();) {
            const auto end = at + std::min(chunk, job_.frames.end() - at);
            step.values.push_back(framesText({at, end}));
            at = end;
        }
        plan_.steps.push_back(std::move(step));
    }

    void check() {
        FarmStep step = rendering("check", {frames_});
        append(step.arguments, {{"--check"}});
        step.values = {"1"};
        plan_.steps.push_back(std::move(step));
    }

    const FarmJob& job_;
    FarmPlan plan_;
    const std::string frames_;
};

}  // namespace

std::string FarmWord::with(const std::string& value) const {
    return varies ? text + value + after : text;
}

std::vector<std::string> FarmStep::argumentsOf(std::size_t index) const {
    std::vector<std::string> words;
    for (const FarmWord& word : arguments) words.push_back(word.with(values[index]));
    return words;
}

std::string framesText(const std::vector<int>& frames) {
    const int first = frames.front(), last = frames.back();
    const int step = frames.size() > 1 ? frames[1] - first : 1;
    bool even = step > 0;
    for (std::size_t i = 1; i < frames.size(); ++i) even &= frames[i] - frames[i - 1] == step;
    if (even && frames.size() > 1)
        return fmt::format("{}-{}{}", first, last, step > 1 ? fmt::format("x{}", step) : "");
    std::string text;
    for (const int frame : frames) text += fmt::format("{}{}", text.empty() ? "" : ",", frame);
    return text;
}

FarmPlan makePlan(const FarmJob& job, FarmPlan place) {
    requireRange("bake-shards", job.shards, 1, kMostShards);
    requireRange("chunk", job.chunk, 1, 1000000);
    requireRange("threads", place.threads, 0, kMaxThreads);
    return Planner(job, std::move(place)).plan();
}

}  // namespace shadowcache
