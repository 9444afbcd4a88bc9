//! Measures of the few families that a step needs.

/// Stands for a group that was not asked for.
const NONE: u32 = u32::MAX;

/// Critical measures of families in the step before, for the groups of neighbouring sites that were asked for: a
/// group costs memory for its values only while it is asked for.
#[derive(Clone, Debug, Default)]
pub struct Measures {
    /// Where the values of each group are; [`NONE`] where none are wanted.
    place: Vec<u32>,
    asked: Vec<u32>,
    values: Vec<f64>,
}

impl Measures {
    /// Forgets everything; groups are below `groups` from here on.
    pub fn start(&mut self, groups: usize) {
        for &group in &self.asked {
            self.place[group as usize] = NONE;
        }
        self.asked.clear();
        self.place.resize(groups, NONE);
    }

    /// Requests a group, again or for the first time.
    pub fn ask(&mut self, group: u32) {
        let place = &mut self.place[group as usize];
        if *place == NONE {
            *place = 0;
            self.asked.push(group);
        }
    }

    /// The groups asked for, in order, and their values to be filled in, `sites` per group.
    pub fn to_fill(&mut self, sites: usize) -> (&[u32], &mut [f64]) {
        self.asked.sort_unstable();
        for (place, &group) in self.asked.iter().enumerate() {
            self.place[group as usize] = place as u32;
        }
        self.values.resize(sites * self.asked.len(), 0.0);
        (&self.asked, &mut self.values)
    }

    /// The value of a site whose group was asked for.
    pub fn of(&self, site: u32, sites: usize) -> f64 {
        let (group, rest) = (site as usize / sites, site as usize % sites);
        self.values[self.place[group] as usize * sites + rest]
    }

    /// Memory held.
    pub fn bytes(&self) -> usize {
        4 * (self.place.capacity() + self.asked.capacity()) + 8 * self.values.capacity()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_belong_to_the_sites_of_the_groups_asked_for() {
        let mut measures = Measures::default();
        for groups in [[7, 2, 7], [0, 7, 9]] {
            measures.start(10);
            groups.into_iter().for_each(|group| measures.ask(group));
            let (asked, values) = measures.to_fill(4);
            for (group, values) in asked.iter().zip(values.chunks_mut(4)) {
                (0..4).for_each(|k| values[k] = f64::from(4 * group) + k as f64);
            }
            for group in groups {
                (0..4).for_each(|k| assert_eq!(measures.of(4 * group + k, 4), f64::from(4 * group + k)));
            }
        }
    }
}
