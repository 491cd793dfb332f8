//! The colours of severities, wherever a conflict is shown: report, pictures, sumo-gui.
//!
//! Blue, orange and red, chosen so that readers with any kind of colour blindness tell them apart, and that each stands out
//! from its ground (the tests compute both). Red is the strongest: what is critical is seen first.

use closecall::detection::kind::Severity;

/// What a colour is drawn on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    /// A white or pale page.
    Light,
    /// A dark page, or sumo-gui's roads.
    Dark,
}

/// Red, green and blue of a severity.
pub fn colour(severity: Severity, ground: Ground) -> [u8; 3] {
    match (ground, severity) {
        (Ground::Light, Severity::Caution) => [0x46, 0x7d, 0xb5],
        (Ground::Light, Severity::Serious) => [0xd9, 0x5f, 0x02],
        (Ground::Light, Severity::Critical) => [0x9b, 0x08, 0x14],
        (Ground::Dark, Severity::Caution) => [0x6f, 0xa8, 0xdc],
        (Ground::Dark, Severity::Serious) => [0xff, 0xab, 0x40],
        (Ground::Dark, Severity::Critical) => [0xff, 0x5c, 0x6c],
    }
}

/// The same as in a style sheet: `#d95f02`.
pub fn hex(severity: Severity, ground: Ground) -> String {
    let [red, green, blue] = colour(severity, ground);
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[cfg(test)]
mod tests {
    use crate::output::palette::*;

    /// What readers see without colour blindness, and with protanopia, deuteranopia and tritanopia (Machado, Oliveira and
    /// Fernandes 2009, severity 1, linear light).
    const EYES: [[[f64; 3]; 3]; 4] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
    ];

    fn linear(colour: [u8; 3]) -> [f64; 3] {
        colour.map(|part| {
            let part = f64::from(part) / 255.0;
            if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
        })
    }

    fn luminance([red, green, blue]: [f64; 3]) -> f64 {
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    }

    /// CIE L*a*b* of linear light, D65.
    fn lab(light: [f64; 3]) -> [f64; 3] {
        let [red, green, blue] = light;
        let part = |t: f64| if t > 0.008856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 };
        let x = part((0.4124 * red + 0.3576 * green + 0.1805 * blue) / 0.95047);
        let y = part(luminance(light));
        let z = part((0.0193 * red + 0.1192 * green + 0.9505 * blue) / 1.08883);
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    #[test]
    fn every_eye_tells_the_severities_apart() {
        for ground in [Ground::Light, Ground::Dark] {
            for eye in EYES {
                let seen = Severity::ALL.map(|severity| {
                    let light = linear(colour(severity, ground));
                    lab(eye.map(|row| (0..3).map(|part| row[part] * light[part]).sum::<f64>().clamp(0.0, 1.0)))
                });
                for (a, b) in [(0, 1), (0, 2), (1, 2)] {
                    let apart = (0..3).map(|part| (seen[a][part] - seen[b][part]).powi(2)).sum::<f64>().sqrt();
                    // 2.3 is just noticeable (Mahy et al. 1994); ten times as much is seen at a glance.
                    assert!(apart > 23.0, "{ground:?}, {eye:?}: {a} and {b} differ by {apart}");
                }
            }
        }
    }

    #[test]
    fn every_severity_stands_out_from_its_ground() {
        for (ground, pages) in
            [(Ground::Light, [[0xff; 3], [0xee, 0xf1, 0xec]]), (Ground::Dark, [[0x1d, 0x21, 0x27], [0, 0, 0]])]
        {
            for (severity, page) in Severity::ALL.into_iter().flat_map(|severity| pages.map(|page| (severity, page))) {
                let [own, other] = [colour(severity, ground), page].map(|colour| luminance(linear(colour)) + 0.05);
                let contrast = own.max(other) / own.min(other);
                // WCAG 2.1, 1.4.11: graphics.
                assert!(contrast >= 3.0, "{severity:?} on {page:02x?}: {contrast}");
            }
        }
    }
}
