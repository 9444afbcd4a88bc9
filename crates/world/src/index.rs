//! Particles by their ids.

/// Finds particles by their ids.
pub struct Index(Vec<u32>);

impl Index {
    /// Of these ids.
    pub fn new(tags: &[u32]) -> Self {
        let mut order: Vec<u32> = (0..tags.len() as u32).collect();
        if !tags.is_sorted() {
            order.sort_unstable_by_key(|&i| tags[i as usize]);
        }
        Self(order)
    }

    /// The place of an id.
    pub fn find(&self, tag: u32, tags: &[u32]) -> Option<usize> {
        let k = self.0.binary_search_by_key(&tag, |&i| tags[i as usize]).ok()?;
        Some(self.0[k] as usize)
    }

    /// Two places with the same id.
    pub fn twice(&self, tags: &[u32]) -> Option<(usize, usize)> {
        let pair = self.0.windows(2).find(|w| tags[w[0] as usize] == tags[w[1] as usize])?;
        Some((pair[0].min(pair[1]) as usize, pair[0].max(pair[1]) as usize))
    }
}
