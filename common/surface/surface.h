#pragma once

#include "common/math/vec.h"

namespace shadowcache {

/// What glTF's metallic-roughness model adds to a base colour. [glTF 2.0, Appendix B;
/// KHR_materials_ior; KHR_materials_specular]
struct Gloss {
    float metallic = 0;   ///< 0 a dielectric over a diffuse base, 1 a metal; mixed between
    float roughness = 1;  ///< 0 a mirror, 1 the roughest
    float ior = 1.5f;     ///< of the dielectric, at least 1; or 0, which reflects everything
    float specular = 1;   ///< strength of the dielectric's reflection, 0 to 1
    Rgb specularColor{
        1.0f, 1.0f,
        1.0f};  ///< factor of the dielectric's reflection at normal incidence, at least 0
};

/// How light leaves a place of a surface: what it emits, a diffuse part, and mirrors.
struct Surface {
    Rgb baseColor{0.0f, 0.0f, 0.0f};
    Rgb diffuse{0.0f, 0.0f, 0.0f};      ///< albedo of the base below the mirrors
    Rgb transmitted{0.0f, 0.0f, 0.0f};  ///< share of light below the mirrors that passes straight
    Rgb f0{0.0f, 0.0f, 0.0f};           ///< reflectance of the mirrors at normal incidence
    Rgb f90{0.0f, 0.0f, 0.0f};          ///< and at grazing incidence
    float loss0 = 0;   ///< share of its light that the base loses to the mirrors, at
    float loss90 = 0;  ///< normal and at grazing incidence
    float roughness = 1;
    Rgb emission{0.0f, 0.0f, 0.0f};  ///< [radiance]
    bool glossy = false;             ///< has mirrors
    bool unlit = false;              ///< emission is all
};

/// A surface with a diffuse part alone.
Surface lambertian(const Rgb& albedo) noexcept;

/// A surface of the metallic-roughness model.
Surface glossy(const Rgb& baseColor, const Gloss& gloss) noexcept;

/// The base of a surface with a share of it, 0 to 1, that transmits light instead of scattering it.
/// [KHR_materials_transmission]
void transmit(float share, Surface& surface) noexcept;

/// Share of light that the mirrors take from the base in a direction.
///
/// @param cosine  between the normal and the direction
float mirroredShare(const Surface& surface, float cosine) noexcept;

/// A surface whose light counts times a factor on its way to the viewer.
Surface scaled(const Surface& surface, const Rgb& factor) noexcept;

/// Albedo of the diffuse part as the viewer sees it: without the share that the mirrors take on the
/// mean over a hemisphere of light.
///
/// @param cosine  between the normal and the direction to the viewer; below 0 it counts as 0
Rgb diffuseAlbedo(const Surface& surface, float cosine) noexcept;

/// Albedo of all that reflects: the diffuse part, and mirrors as if they were smooth.
///
/// @param cosine  as of diffuseAlbedo()
Rgb reflectance(const Surface& surface, float cosine) noexcept;

/// What a glossy surface reflects to a viewer besides diffuseAlbedo(): the mirrors' lobe, and the
/// difference between what the base loses to them in a direction and on the mean. Together with
/// diffuseAlbedo() / pi times the cosine this is the BRDF times the cosine, exactly.
class GlossyLobe {
public:
    /// Roughness below which a lobe is no narrower: its width is then that of a texel of a map of
    /// 4096 x 2048 texels.
    static constexpr float kLeastRoughness = 0.03125f;
    /// Cosine of the viewer's direction below which the normal is bent toward the viewer.
    static constexpr float kLeastCosine = 0.01f;

    /// @param normal, toViewer  unit vectors; a normal that faces away from the viewer is turned
    /// until it just faces the viewer
    GlossyLobe(const Surface& surface, const Vec3f& normal, const Vec3f& toViewer) noexcept;

    /// Normal that the lobe stands on.
    const Vec3f& normal() const { return n_; }

    /// Reflected share of the radiance from `toLight` (unit vector), times the cosine; 0 below the
    /// horizon. Can be slightly negative where the base loses more than on the mean. [1/sr]
    Rgb value(const Vec3f& toLight) const noexcept;

    /// Directions of a call of values().
    static constexpr int kLanes = 16;
    /// The same of sixteen directions at once, up to rounding.
    ///
    /// @param toLight  [x, y, z]: unit vectors
    /// @param values   [colour]
    void values(const float (&toLight)[3][kLanes], float (&values)[3][kLanes]) const noexcept;

    /// Square of the roughness: the width of the mirrors' normals, about.
    float alpha() const { return alpha_; }
    /// The same lobe of mirrors whose normals spread by at least `alpha`.
    GlossyLobe widened(float alpha) const noexcept {
        GlossyLobe lobe = *this;
        lobe.alpha_ = alpha_ > alpha ? alpha_ : alpha;
        return lobe;
    }
    /// The same place's lobe toward another viewer. What the base loses on the mean is that of this
    /// one, whose diffuseAlbedo() it adds to.
    ///
    /// @param normal  that this lobe was made with
    GlossyLobe seenFrom(const Vec3f& normal, const Vec3f& toViewer) const noexcept;
    /// Unit vector from which a smooth surface would reflect light to the viewer.
    Vec3f mirrored() const noexcept;

    /// Density with which sample() draws a direction [1/sr].
    float density(const Vec3f& toLight) const noexcept;

    /// A direction in proportion to the light that the visible mirrors reflect, about; below the
    /// horizon where a mirror reflects into the surface, where value() is 0.
    ///
    /// @param u, v  in [0, 1)
    Vec3f sample(float u, float v) const noexcept;

private:
    Vec3f local(const Vec3f& w) const noexcept { return {w.dot(s_), w.dot(t_), w.dot(n_)}; }

    Vec3f s_, t_, n_;  ///< the lobe's space
    Vec3f o_;          ///< to the viewer, there
    float alpha_;
    Rgb f0_, f90_;
    Rgb loss_;          ///< of the base between normal and grazing incidence, over pi
    float meanWeight_;  ///< of grazing incidence
};

}  // namespace shadowcache
