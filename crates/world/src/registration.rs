//! How styles register state that has a role for others, or that a motion of matter changes.

use super::acting::by_name;
use super::moving::Under;
use super::named::{Constant, Key};
use super::{Numbers, World};

/// State that a style keeps under names of one form, `BEGIN…END`. The style makes the keys with [`Registration::key`], and its
/// `Style::registrations` lists them, so that names from a restart file are registered before the deck declares the style again.
pub struct Registration {
    begin: &'static str,
    end: &'static str,
    role: Role,
    under: Option<Under>,
}

/// What entries are to other styles.
enum Role {
    /// Nothing.
    None,
    /// One role for all.
    One(&'static Constant<Vec<f64>>),
    /// What stands behind the ID: `BEGIN ID/ROLE`.
    Tail,
}

impl Registration {
    /// State that plays a role.
    pub const fn role(begin: &'static str, end: &'static str, role: &'static Constant<Vec<f64>>) -> Self {
        Self { begin, end, role: Role::One(role), under: None }
    }

    /// State with names `BEGIN ID/ROLE`.
    pub const fn roles(begin: &'static str) -> Self {
        Self { begin, end: "", role: Role::Tail, under: None }
    }

    /// Vector columns that a motion of matter changes as `under` states.
    pub const fn moved(begin: &'static str, end: &'static str, under: Under) -> Self {
        Self { begin, end, role: Role::None, under: Some(under) }
    }

    /// The key of the name that begins with `text` and ends as these names do.
    ///
    /// # Panics
    ///
    /// Debug builds panic where `text` does not begin as these names do.
    #[track_caller]
    pub fn key<T>(&self, text: &str) -> Key<T> {
        let text = format!("{text}{}", self.end);
        by_name(&text);
        debug_assert!(self.fits(&text), "`{text}` is not registered as `{}…{}`", self.begin, self.end);
        let key = Key::new(&text);
        self.register(key);
        key
    }

    fn fits(&self, text: &str) -> bool {
        text.strip_prefix(self.begin).is_some_and(|rest| rest.ends_with(self.end))
    }

    /// Registers a name of this form.
    fn register<T>(&self, key: Key<T>) {
        let tail = || key.text().strip_prefix(self.begin)?.split_once('/').map(|(_, tail)| tail);
        let role = match self.role {
            Role::None => None,
            Role::One(role) => Some(role.text()),
            Role::Tail => tail(),
        };
        role.map(|role| key.in_role(role));
        self.under.map(|under| key.moved(under));
    }
}

impl World {
    /// Registers the names that a restart file has brought: of several registrations that fit a name the first one counts.
    pub fn register<'a>(&self, all: impl Iterator<Item = &'a Registration> + Clone) {
        let columns = self.columns.names().into_iter().map(Key::new);
        let names: Vec<Numbers> = self.memo.keys().chain(columns).collect();
        for key in names {
            if let Some(registration) = all.clone().find(|r| r.fits(key.text())) {
                registration.register(key);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    static ROLE: Constant<Vec<f64>> = Constant::new("/test role");
    static PLAYS: Registration = Registration::role("registered/", "/test role", &ROLE);
    static HELD: Registration = Registration::moved("registered/", "", Under::Anchor);

    #[test]
    fn names_have_what_their_owner_has_registered() {
        let key: Numbers = PLAYS.key("registered/1");
        assert!(key.plays(*ROLE) && key.text() == "registered/1/test role" && key.under().is_none());
        assert_eq!(HELD.key::<f64>("registered/2").under(), Some(Under::Anchor));
        static OWN: Registration = Registration::roles("own/");
        assert_eq!(OWN.key::<f64>("own/f/d2_c/1").role(), Some(Key::new("d2_c/1")));
    }

    #[test]
    fn names_from_a_file_are_registered_by_the_first_form_that_fits() {
        let mut w = World::default();
        let [plays, held] = ["registered/3/test role", "registered/3"].map(Numbers::new);
        w.memo.insert(plays, vec![1.0]);
        w.columns.scalar(held, 0);
        assert_eq!((w.memo.playing(*ROLE).count(), held.under()), (0, None));
        w.register([&PLAYS, &HELD].into_iter());
        assert!(w.memo.playing(*ROLE).eq([(plays, &vec![1.0])]));
        assert_eq!((plays.under(), held.under()), (None, Some(Under::Anchor)));
    }
}
