#pragma once

namespace shadowcache {

/// Replaces the clamped cosine max(0, x), x = n . w, over a region that the horizon cuts by its
/// least-squares quadratic, whose integral against the light follows exactly from the moments.
/// With x = height + sinRadius t, t in [-1, 1], the cosine has its kink at t0 = -height / sinRadius
/// and the quadratic is its projection on the Legendre polynomials P0, P1, P2.
struct HorizonFit {
    float constant, linear, square;  ///< q(x) = constant + linear x + square x^2
    float cosineMoment;              ///< mean of max(0, x)^2 over t
    float fitMoment;                 ///< mean of q^2, which is that of q max(0, x) as well

    /// @param height     n . axis of the region, |height| < sinRadius
    /// @param sinRadius  sine of its angular radius, above 0
    HorizonFit(float height, float sinRadius) {
        const float t0 = -height / sinRadius;
        const float rest = 1 - t0;
        const float both = 1 - t0 * t0;
        const float c0 = sinRadius * rest * rest / 4;
        const float c1 = sinRadius * (0.5f - 0.75f * t0 + 0.25f * t0 * t0 * t0);
        const float c2 = sinRadius * both * both * (5.0f / 16);
        const float slope = 1 / sinRadius;
        constant = c0 + c1 * t0 + c2 * (1.5f * t0 * t0 - 0.5f);
        linear = slope * (c1 + 3 * c2 * t0);
        square = slope * slope * 1.5f * c2;
        cosineMoment = sinRadius * sinRadius * rest * rest * rest / 6;
        fitMoment = c0 * c0 + c1 * c1 / 3 + c2 * c2 / 5;
    }

    /// The quadratic at x = n . w.
    float operator()(float x) const { return constant + x * (linear + x * square); }
};

}  // namespace shadowcache
