"""The colour of a Blackbody node: light of a black body by Planck's law, seen by the CIE 1931 standard observer.

Linear Rec.709 of luminance 1 before what is below 0 is set to 0, as Cycles shows it.
"""

import math

import numpy

RANGE = 800.0, 12000.0  # kelvins; beyond them Cycles shows the colour of the nearer end
RADIATION = 1.4387769e-2  # Planck's second constant, metres times kelvins
# Colour matching functions of the CIE 1931 2 degree observer, each 10 nm from 380 nm on.
FIRST, STEP = 380e-9, 10e-9
X = (0.001368, 0.004243, 0.01431, 0.04351, 0.13438, 0.2839, 0.34828, 0.3362, 0.2908, 0.19536, 0.09564, 0.03201, 0.0049, 0.0093,
     0.06327, 0.1655, 0.2904, 0.43345, 0.5945, 0.7621, 0.9163, 1.0263, 1.0622, 1.0026, 0.85445, 0.6424, 0.4479, 0.2835, 0.1649,
     0.0874, 0.04677, 0.0227, 0.011359, 0.00579, 0.002899, 0.00144, 0.00069, 0.000332, 0.000166, 0.000083, 0.000042)
Y = (0.000039, 0.00012, 0.000396, 0.00121, 0.004, 0.0116, 0.023, 0.038, 0.06, 0.09098, 0.13902, 0.20802, 0.323, 0.503, 0.71, 0.862,
     0.954, 0.99495, 0.995, 0.952, 0.87, 0.757, 0.631, 0.503, 0.381, 0.265, 0.175, 0.107, 0.061, 0.032, 0.017, 0.00821, 0.004102,
     0.002091, 0.001047, 0.00052, 0.000249, 0.00012, 0.00006, 0.00003, 0.000015)
Z = (0.00645, 0.02005, 0.06785, 0.2074, 0.6456, 1.3856, 1.74706, 1.77211, 1.6692, 1.28764, 0.81295, 0.46518, 0.272, 0.1582,
     0.07825, 0.04216, 0.0203, 0.00875, 0.0039, 0.0021, 0.00165, 0.0011, 0.0008, 0.00034, 0.00019, 0.00005, 0.00002, *[0] * 14)
REC709 = ((3.2404542, -1.5371385, -0.4985314), (-0.9692660, 1.8760108, 0.0415560), (0.0556434, -0.2040259, 1.0572252))  # of XYZ


def colour(kelvins):
    """Three numbers, of a temperature."""
    kelvins = min(max(kelvins, RANGE[0]), RANGE[1])
    lengths = [FIRST + STEP * i for i in range(len(X))]
    light = [(FIRST / length) ** 5 / math.expm1(RADIATION / (length * kelvins)) for length in lengths]
    seen = numpy.array((X, Y, Z)) @ light
    return tuple(max(number, 0.0) for number in (numpy.array(REC709) @ (seen / seen[1])).tolist())
