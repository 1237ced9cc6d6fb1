//! Materials known by name.

/// Index of refraction and absorption in linear sRGB: Mitsuba's measured spectra, reduced to three
/// bands as Mitsuba itself does in RGB mode.
pub(super) const CONDUCTORS: [(&str, [f32; 3], [f32; 3]); 5] = [
    ("none", [0.0, 0.0, 0.0], [1.0, 1.0, 1.0]),
    ("Au", [0.1430, 0.3753, 1.4421], [3.9830, 2.3856, 1.6034]),
    ("Ag", [0.1553, 0.1167, 0.1384], [4.8284, 3.1222, 2.1469]),
    ("Cu", [0.2010, 0.9238, 1.1022], [3.9133, 2.4531, 2.1421]),
    ("Al", [1.6575, 0.8804, 0.5212], [9.2238, 6.2695, 4.8370]),
];

/// Index of refraction at the sodium D line.
pub(super) const IORS: [(&str, f32); 23] = [
    ("vacuum", 1.0),
    ("helium", 1.000_036),
    ("hydrogen", 1.000_132),
    ("air", 1.000_277),
    ("carbon dioxide", 1.000_45),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.520_45),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.575),
    ("diamond", 2.419),
];
