//! How red, green and blue come from the channels that a scene carries.
//!
//! Light does not mix between colours, so a colour whose light is everywhere the same multiple of
//! another's need not be propagated twice: a white scene carries one channel, a scene of red and
//! yellow lights two (red sees both, green one, blue is dark).

/// One colour as a multiple of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// The channel, from 0.
    pub channel: usize,
    /// What its light is multiplied by.
    pub scale: f64,
}

/// Which channel, times what, is red, green and blue.
#[derive(Clone, Debug, PartialEq)]
pub struct Channels {
    rgb: [Share; 3],
    /// For each channel, the colour (0 red, 1 green, 2 blue) that it carries unscaled.
    leaders: Vec<usize>,
}

impl Channels {
    /// The fewest channels for a set of sources, each of a colour (red, green, blue ≥ 0).
    pub fn of_colors(colors: &[[f64; 3]]) -> Self {
        let weights: [Vec<f64>; 3] = std::array::from_fn(|c| colors.iter().map(|color| color[c]).collect());
        let mut leaders: Vec<usize> = Vec::new();
        let mut rgb = [Share { channel: 0, scale: 0.0 }; 3];
        for c in 0..3 {
            if weights[c].iter().all(|w| *w == 0.0) {
                continue;
            }
            let known = leaders.iter().enumerate().find_map(|(channel, &leader)| {
                multiple(&weights[c], &weights[leader]).map(|scale| Share { channel, scale })
            });
            rgb[c] = known.unwrap_or_else(|| {
                leaders.push(c);
                Share { channel: leaders.len() - 1, scale: 1.0 }
            });
        }
        if leaders.is_empty() {
            leaders.push(0);
        }
        Channels { rgb, leaders }
    }

    /// One channel a colour, whatever the sources: for scenes whose surfaces change the colour of light.
    pub fn separate() -> Self {
        Channels { rgb: std::array::from_fn(|channel| Share { channel, scale: 1.0 }), leaders: vec![0, 1, 2] }
    }

    /// How many channels are carried, 1 to 3.
    pub fn count(&self) -> usize {
        self.leaders.len()
    }

    /// What red, green and blue are made of; scale 0 where a colour is dark.
    pub fn rgb(&self) -> [Share; 3] {
        self.rgb
    }

    /// The part of a source's colour that goes into `channel`.
    pub fn weight(&self, channel: usize, color: [f64; 3]) -> f64 {
        color[self.leaders[channel]]
    }
}

/// The factor s with a = s·b, if there is one. Only exact multiples count: what is shown must be what
/// three separate channels would have shown.
fn multiple(a: &[f64], b: &[f64]) -> Option<f64> {
    let at = b.iter().position(|w| *w != 0.0)?;
    let scale = a[at] / b[at];
    a.iter().zip(b).all(|(a, b)| (a - scale * b).abs() <= 1e-12 * a.abs()).then_some(scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_white_scene_carries_one_channel() {
        let channels = Channels::of_colors(&[[1.0; 3], [0.5; 3]]);
        assert_eq!(channels.count(), 1);
        assert!(channels.rgb().iter().all(|share| *share == Share { channel: 0, scale: 1.0 }));
    }

    #[test]
    fn proportional_colours_share_and_dark_ones_cost_nothing() {
        let channels = Channels::of_colors(&[[0.0, 0.5, 1.0], [0.0, 0.25, 0.5]]);
        assert_eq!(channels.count(), 1);
        assert_eq!(channels.rgb().map(|s| s.scale), [0.0, 1.0, 2.0]);
        let dark = Channels::of_colors(&[]);
        assert_eq!((dark.count(), dark.rgb().map(|s| s.scale)), (1, [0.0; 3]));
    }

    #[test]
    fn every_colour_of_every_source_is_restored() {
        let colors = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.3, 0.2, 0.1]];
        for some in 1..=3 {
            let channels = Channels::of_colors(&colors[..some]);
            assert_eq!(channels.count(), some);
            for color in &colors[..some] {
                for (c, share) in channels.rgb().iter().enumerate() {
                    let restored = share.scale * channels.weight(share.channel, *color);
                    assert!((restored - color[c]).abs() < 1e-15);
                }
            }
        }
    }
}
