#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "common/farm/farm_files.h"

namespace shadowcache {

// Open Job Description, "Template Schemas [Version: 2023-09]".

namespace {

using nlohmann::ordered_json;

/// Seconds from SIGTERM to SIGKILL; the programs end within five.
constexpr int kNotifySeconds = 10;

ordered_json stepOf(const FarmStep& step, const FarmStep* before) {
    ordered_json json{{"name", step.name}};
    if (before) json["dependencies"] = ordered_json::array({{{"dependsOn", before->name}}});
    const std::size_t tasks = step.values.size();
    const std::string range = tasks > 1 ? fmt::format("1-{}", tasks) : "1";
    json["parameterSpace"]["taskParameterDefinitions"] =
        ordered_json::array({{{"name", "Task"}, {"type", "INT"}, {"range", range}}});
    json["script"]["actions"]["onRun"] = {
        {"command", "{{Param.JobFolder}}/run"},
        {"args", {"again", step.name, "{{Task.Param.Task}}"}},
        {"cancelation",
         {{"mode", "NOTIFY_THEN_TERMINATE"}, {"notifyPeriodInSeconds", kNotifySeconds}}}};
    return json;
}

}  // namespace

std::vector<FarmFile> openjdFiles(const FarmPlan& plan) {
    ordered_json json{{"specificationVersion", "jobtemplate-2023-09"},
                      {"name", "shadowcache"},
                      {"description", "Bake, frames and check of one shot."}};
    // Relative to the template, as a default must be.
    json["parameterDefinitions"] = ordered_json::array({{{"name", "JobFolder"},
                                                         {"type", "PATH"},
                                                         {"objectType", "DIRECTORY"},
                                                         {"dataFlow", "INOUT"},
                                                         {"default", "."}}});
    json["steps"] = ordered_json::array();
    const FarmStep* before = nullptr;
    for (const FarmStep& step : plan.steps) {
        json["steps"].push_back(stepOf(step, before));
        before = &step;
    }
    return {{"openjd.json", json.dump(2) + "\n", false}};
}

}  // namespace shadowcache
