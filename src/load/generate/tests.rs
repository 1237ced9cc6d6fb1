use super::*;

/// FNV-1a over the bits of positions, then corners.
fn hash(mesh: &Mesh) -> u64 {
    let positions = mesh.positions.iter().flat_map(Vec3::to_array).map(f32::to_bits);
    let words = positions.chain(mesh.triangles.iter().flatten().copied());
    words
        .flat_map(u32::to_le_bytes)
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// Taken from the program that other ray tracers are measured with.
#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
#[test]
fn meshes_have_the_bits_that_others_are_measured_on() {
    for (spec, vertices, triangles, bits) in [
        ("soup:20k", 60_000, 20_000, 0x3cac_0e81_881f_b15e),
        ("soup:20k:7", 60_000, 20_000, 0x3c19_a50d_9025_1fc7),
        ("terrain:20k", 10_201, 20_000, 0xd551_aa64_ef37_ab4c),
        ("spheres:20k", 8_340, 16_640, 0x6048_4225_4365_4a54),
        ("hair:20k", 22_500, 20_000, 0x3072_d435_af5e_0ad0),
        ("terrain:1M", 501_264, 999_698, 0x99c1_5ff3_b78b_df62),
        ("spheres:1M", 526_440, 1_049_600, 0x8fde_9ef6_d0c2_f769),
        ("soup:1", 3, 1, 0x7e98_faec_7910_509d),
        ("terrain:1", 4, 2, 0x88ab_0c03_a1b5_9f9b),
        ("spheres:1", 12, 20, 0xf110_3f21_88cd_880d),
        ("hair:1", 18, 1, 0xfa1d_d10a_eba1_4d14),
    ] {
        let mesh = mesh(spec).unwrap();
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (vertices, triangles), "{spec}");
        assert_eq!(hash(&mesh), bits, "{spec}");
    }
}

#[test]
fn every_corner_is_a_finite_vertex() {
    for spec in ["soup:3k", "terrain:3K", "spheres:3000", "hair:3001:9"] {
        let mesh = mesh(spec).unwrap();
        assert!(mesh.positions.iter().all(|p| p.is_finite()), "{spec}");
        assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < mesh.positions.len()), "{spec}");
    }
}

#[test]
fn slips_are_refused_with_the_way_out() {
    for (spec, expected) in [
        ("foo:10", "gen:foo:10: there is no mesh of the kind `foo`"),
        ("", "gen:: there is no mesh of the kind ``"),
        ("soup", "gen:soup: how many triangles?"),
        ("soup:", "gen:soup:: expected a number of triangles, found ``"),
        ("soup:x", "gen:soup:x: expected a number of triangles, found `x`"),
        ("soup:k", "gen:soup:k: expected a number of triangles, found `k`"),
        ("soup:0", "gen:soup:0: expected a number of triangles, found `0`"),
        ("soup:-1", "gen:soup:-1: expected a number of triangles, found `-1`"),
        ("soup:1.5k", "gen:soup:1.5k: expected a number of triangles, found `1.5k`"),
        ("hair:101M", "gen:hair:101M: 101M triangles are more than 100000000"),
        (
            "hair:99999999999999999999999M",
            "gen:hair:99999999999999999999999M: 99999999999999999999999M triangles are more than 100000000",
        ),
        ("soup:1k:x", "gen:soup:1k:x: the seed is not a whole number below 2^64"),
        ("soup:1k:1:2", "gen:soup:1k:1:2: nothing may follow the seed, found `2`"),
        ("spheres:1k:1", "gen:spheres:1k:1: the spheres have no seed: nothing about them is random"),
    ] {
        assert_eq!(mesh(spec).unwrap_err().to_string(), expected);
    }
}
