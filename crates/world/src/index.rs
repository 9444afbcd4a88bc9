//! Particles by their ids.

/// Finds particles by their ids.
pub enum Index {
    /// The place of each id, where ids are not far more than particles.
    Table(Vec<u32>),
    /// Places by ascending id.
    Sorted(Vec<u32>),
}

/// No particle has this id.
const NO_PARTICLE: u32 = u32::MAX;

impl Index {
    /// Of these ids.
    pub fn new(tags: &[u32]) -> Self {
        let most = tags.iter().max().map_or(0, |m| *m as usize);
        if most <= 4 * tags.len() {
            let mut table = vec![NO_PARTICLE; most + 1];
            for (place, tag) in tags.iter().enumerate() {
                table[*tag as usize] = place as u32;
            }
            return Self::Table(table);
        }
        Self::Sorted(by_id(tags))
    }

    /// The place of an id.
    pub fn find(&self, tag: u32, tags: &[u32]) -> Option<usize> {
        match self {
            Self::Table(table) => table.get(tag as usize).filter(|p| **p != NO_PARTICLE).map(|p| *p as usize),
            Self::Sorted(order) => {
                let k = order.binary_search_by_key(&tag, |&i| tags[i as usize]).ok()?;
                Some(order[k] as usize)
            }
        }
    }
}

/// Places by ascending id.
fn by_id(tags: &[u32]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..tags.len() as u32).collect();
    if !tags.is_sorted() {
        order.sort_unstable_by_key(|&i| tags[i as usize]);
    }
    order
}

/// Two places with the same id.
pub fn twice(tags: &[u32]) -> Option<(usize, usize)> {
    let order = by_id(tags);
    let pair = order.windows(2).find(|w| tags[w[0] as usize] == tags[w[1] as usize])?;
    Some((pair[0].min(pair[1]) as usize, pair[0].max(pair[1]) as usize))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_find_the_same() {
        for tags in [vec![4, 2, 7, 1], vec![4, 2_000_000, 7, 1], vec![]] {
            let index = Index::new(&tags);
            for id in [0, 1, 2, 3, 4, 7, 8, 2_000_000, 3_000_000_000] {
                assert_eq!(index.find(id, &tags), tags.iter().position(|t| *t == id), "{id} of {tags:?}");
            }
        }
        assert_eq!((twice(&[3, 1, 2]), twice(&[3, 1, 3])), (None, Some((0, 2))));
    }
}
