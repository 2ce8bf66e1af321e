// Reads --env-rotate; Environment::turn() (common/light/environment.cpp) applies it.

#include "render/shot/light_rotation.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "common/base/error.h"
#include "common/base/number_text.h"
#include "common/base/option_checks.h"

namespace shadowcache {

namespace {

constexpr std::size_t kAngles = 3, kMatrix = 9;

/// What a matrix typed with six digits may differ by; it is made orthogonal.
constexpr double kLargestError = 1e-4;

/// Rows of a matrix.
std::array<Vec3d, 3> rowsOf(const std::vector<double>& n) {
    return {Vec3d(n[0], n[1], n[2]), Vec3d(n[3], n[4], n[5]), Vec3d(n[6], n[7], n[8])};
}

void requireOrthogonal(const std::string& option, const std::vector<double>& numbers) {
    const std::array<Vec3d, 3> rows = rowsOf(numbers);
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j) {
            const double product = rows[i].dot(rows[j]);
            if (std::abs(product - (i == j ? 1 : 0)) <= kLargestError) continue;
            const std::string what =
                i == j
                    ? fmt::format("row {} has the length {}", i + 1, numberText(std::sqrt(product)))
                    : fmt::format("row {} times row {} is {}", i + 1, j + 1, numberText(product));
            throw Error(
                fmt::format("{}: {}, expected rows of length 1 at right angles", option, what));
        }
}

/// First and last angle of "A" or "A-B".
std::array<double, 2> anglesOf(const std::string& option, const std::string& text) {
    double first = 0, last = 0;
    int firstEnd = 0, end = 0;
    const auto length = static_cast<int>(text.size());
    std::sscanf(text.c_str(), "%lf%n-%lf%n", &first, &firstEnd, &last, &end);
    if (firstEnd == length) last = first;
    if (firstEnd == 0 || (firstEnd != length && end != length))
        throw Error(option +
                    ": expected degrees, A-B to turn from A to B, three angles X,Y,Z or the nine "
                    "numbers of a matrix");
    return {first, last};
}

void requireAngle(double angle) {
    requireRange("env-rotate", angle, -1e6, 1e6);
}

}  // namespace

Turn LightRotation::turn() const {
    if (numbers.size() == kAngles) return turnByAngles({numbers[0], numbers[1], numbers[2]});
    if (numbers.size() != kMatrix) return turnByAngles({0, numbers[0], 0});
    std::array<Vec3d, 3> rows = rowsOf(numbers);
    rows[0].normalize();
    rows[1] = (rows[1] - rows[0] * rows[0].dot(rows[1])).normalized();
    const Vec3d third = rows[0].cross(rows[1]);
    rows[2] = third.dot(rows[2]) < 0 ? -third : third;
    Turn turn;
    for (int column = 0; column < 3; ++column)
        turn.axis[static_cast<std::size_t>(column)] = {rows[0][column], rows[1][column],
                                                       rows[2][column]};
    return turn;
}

std::string LightRotation::text() const {
    std::string all;
    for (const double number : numbers) {
        if (!all.empty()) all += ',';
        all += numberText(number);
    }
    return all;
}

std::vector<double> parseNumbers(const std::string& text) {
    std::vector<double> numbers;
    TextReader parts(text);
    for (std::string part; std::getline(parts, part, ',');) {
        double number = 0;
        int end = 0;
        if (std::sscanf(part.c_str(), "%lf%n", &number, &end) != 1 ||
            end != static_cast<int>(part.size()) || !std::isfinite(number))
            return {};
        numbers.push_back(number);
    }
    if (text.ends_with(',')) return {};
    return numbers;
}

LightRotations parseRotation(const std::string& text) {
    const std::string option = "--env-rotate " + text;
    const std::vector<double> numbers = parseNumbers(text);
    if (numbers.size() == kAngles) {
        for (const double angle : numbers) requireAngle(angle);
        return {{numbers}, {numbers}};
    }
    if (numbers.size() == kMatrix) {
        requireOrthogonal(option, numbers);
        return {{numbers}, {numbers}};
    }
    if (text.find(',') != text.npos)
        throw Error(
            fmt::format("{}: {} parts, expected numbers: one angle, three, or the nine of a matrix",
                        option, std::ranges::count(text, ',') + 1));
    const auto [first, last] = anglesOf(option, text);
    for (const double angle : {first, last}) requireAngle(angle);
    return {{{first}}, {{last}}};
}

}  // namespace shadowcache
