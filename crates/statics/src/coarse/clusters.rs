//! Formation of clusters, and rigid motions of their members.

use crate::pairs::Lists;
use crate::six::Six;
use perigrain_base::math::vec3::{Vec3, add, cross, scale, sub};
use perigrain_base::par;

/// The cluster index of fixed nodes.
pub const NONE: u32 = u32::MAX;

/// Clusters of nodes, which are particles or clusters.
pub struct Clusters {
    /// By node; [`NONE`] for fixed nodes.
    pub of: Vec<u32>,
    /// Vector from the centre of the cluster to the node [length]. Single precision: a slightly different
    /// cluster is equally good.
    offset: Vec<[f32; 3]>,
    /// The nodes of each cluster.
    members: Lists,
}

impl Clusters {
    /// `rings` of neighbours make a cluster; `neighbours(node, take)` passes the neighbours of a node to `take`, with the vectors to them [length].
    pub fn new(
        nodes: usize,
        rings: usize,
        stands: impl Fn(usize) -> bool,
        neighbours: impl Fn(usize, &mut dyn FnMut(usize, Vec3)),
    ) -> Self {
        let mut out =
            Self { of: vec![NONE; nodes], offset: vec![[0.0; 3]; nodes], members: Lists::default() };
        let count = out.begin(rings, &stands, &neighbours);
        out.join(&stands, &neighbours);
        let held = out.of.iter().enumerate().filter(|(_, cluster)| **cluster != NONE);
        out.members = Lists::new(count as usize, held.map(|(k, cluster)| (*cluster, k as u32)));
        out.centre();
        out
    }

    /// A node without neighbours in a cluster forms one with all of them, and with their neighbours; offsets
    /// are relative to that node. Returns the number of clusters.
    fn begin(
        &mut self,
        rings: usize,
        stands: &impl Fn(usize) -> bool,
        neighbours: &impl Fn(usize, &mut dyn FnMut(usize, Vec3)),
    ) -> u32 {
        let mut count = 0;
        for k in (0..self.of.len()).filter(|k| !stands(*k)) {
            let mut begins = self.of[k] == NONE;
            neighbours(k, &mut |j, _| begins &= self.of[j] == NONE);
            if !begins {
                continue;
            }
            self.of[k] = count;
            let mut ring = vec![k];
            for _ in 0..rings {
                let mut next = vec![];
                for i in ring {
                    let x = self.offset(i);
                    neighbours(i, &mut |j, d| {
                        if self.of[j] == NONE && !stands(j) {
                            (self.of[j], self.offset[j]) = (count, single(add(x, d)));
                            next.push(j);
                        }
                    });
                }
                ring = next;
            }
            count += 1;
        }
        count
    }

    /// Remaining nodes join the cluster that most of their neighbours were in before this stage.
    fn join(
        &mut self,
        stands: &impl Fn(usize) -> bool,
        neighbours: &impl Fn(usize, &mut dyn FnMut(usize, Vec3)),
    ) {
        let first = self.of.clone();
        for k in (0..first.len()).filter(|k| first[*k] == NONE && !stands(*k)) {
            // Cluster, number of neighbours in it, and position relative to the first of them.
            let mut near: Vec<(u32, u32, Vec3)> = vec![];
            neighbours(k, &mut |j, d| match near.iter_mut().find(|n| n.0 == first[j]) {
                _ if first[j] == NONE => {}
                Some(n) => n.1 += 1,
                None => near.push((first[j], 1, sub(self.offset(j), d))),
            });
            // Some neighbour is in a cluster; otherwise this node would have started one.
            if let Some((cluster, _, x)) = near.iter().reduce(|best, n| if n.1 > best.1 { n } else { best }) {
                (self.of[k], self.offset[k]) = (*cluster, single(*x));
            }
        }
    }

    /// Makes offsets relative to the centre of each cluster.
    fn centre(&mut self) {
        for row in (0..self.count()).map(|cluster| self.members.of(cluster)) {
            let sum = row.iter().fold([0.0; 3], |sum, k| add(sum, self.offset[*k as usize].map(f64::from)));
            let middle = scale(1.0 / row.len() as f64, sum);
            for x in row.iter().map(|k| *k as usize) {
                self.offset[x] = single(sub(self.offset[x].map(f64::from), middle));
            }
        }
    }

    /// Vector from the centre of its cluster to a node [length].
    #[inline(always)]
    pub fn offset(&self, k: usize) -> Vec3 {
        self.offset[k].map(f64::from)
    }

    /// The number of clusters.
    pub fn count(&self) -> usize {
        self.members.len()
    }

    /// The nodes of a cluster.
    pub fn members(&self, cluster: usize) -> impl Iterator<Item = usize> {
        self.members.of(cluster).iter().map(|k| *k as usize)
    }

    /// A sum over the nodes of each cluster.
    pub fn sums(&self, of: impl Fn(usize) -> f64) -> Vec<f64> {
        (0..self.count()).map(|cluster| self.members(cluster).map(&of).sum()).collect()
    }

    /// Pᵀ r: forces and torques on nodes summed to clusters.
    pub fn gather(&self, r: impl Fn(usize) -> Six + Sync) -> Vec<Six> {
        let mut out = vec![[0.0; 6]; self.count()];
        par::each(&mut out[..], |start, rows: &mut [Six]| {
            for (cluster, row) in (start..).zip(rows) {
                for k in self.members(cluster) {
                    let f = handed(self.offset(k), &r(k));
                    row.iter_mut().zip(f).for_each(|(sum, a)| *sum += a);
                }
            }
        });
        out
    }
}

fn single(x: Vec3) -> [f32; 3] {
    x.map(|x| x as f32)
}

/// The motion at x of a rigid body: u + θ × x, θ.
#[inline(always)]
pub fn carried(x: Vec3, m: &Six) -> Six {
    let more = cross([m[3], m[4], m[5]], x);
    [m[0] + more[0], m[1] + more[1], m[2] + more[2], m[3], m[4], m[5]]
}

/// Force and torque at x as those on the rigid body: F, M + x × F.
#[inline(always)]
pub fn handed(x: Vec3, f: &Six) -> Six {
    let more = cross(x, [f[0], f[1], f[2]]);
    [f[0], f[1], f[2], f[3] + more[0], f[4] + more[1], f[5] + more[2]]
}
