//! Heat that contacts conduct.

use perigrain_contact::Heat;
use perigrain_contact::driver::Rules;
use perigrain_world::columns::{HEATFLOW, TEMPERATURE};
use perigrain_world::{Numbers, World};

/// Temperatures of particles, and the heat that flows into them.
pub struct Heating {
    /// Temperatures.
    pub temperature: Vec<f64>,
    /// Heat [energy/time].
    pub flow: Vec<f64>,
    /// Both columns.
    keys: [Numbers; 2],
}

impl Heating {
    /// Taken out of the world, if some contacts conduct heat and particles have both.
    pub fn take(w: &mut World, rules: &Rules) -> Option<Self> {
        if !conducts(rules) {
            return None;
        }
        let keys = [w.columns.property(*TEMPERATURE)?, w.columns.property(*HEATFLOW)?];
        let n = w.n();
        let [temperature, flow] = keys.map(|key| std::mem::take(w.columns.scalar(key, n)));
        Some(Self { temperature, flow, keys })
    }

    /// Put back.
    pub fn give(self, w: &mut World) {
        let n = w.n();
        *w.columns.scalar(self.keys[0], n) = self.temperature;
        *w.columns.scalar(self.keys[1], n) = self.flow;
    }
}

/// Whether some contacts conduct heat.
pub fn conducts(rules: &Rules) -> bool {
    rules.any(|r| r.law.heat != Heat::None)
}
