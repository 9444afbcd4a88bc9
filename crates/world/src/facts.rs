//! What styles and the program keep in a scene under keys that name the type: each kind belongs to the crate that has the type and the key.

use super::named::{Key, Named};
use std::any::Any;
use std::fmt::Debug;

/// Values of any types by name. Copies of a scene have copies; restart files do not hold them.
#[derive(Clone, Debug, Default)]
pub struct Facts(Named<Box<dyn Fact>>);

/// What can be kept.
trait Fact: Any + Debug + Send + Sync {
    fn copy(&self) -> Box<dyn Fact>;
}

impl<T: Any + Clone + Debug + Send + Sync> Fact for T {
    fn copy(&self) -> Box<dyn Fact> {
        Box::new(self.clone())
    }
}

impl Clone for Box<dyn Fact> {
    fn clone(&self) -> Self {
        (**self).copy()
    }
}

impl Facts {
    /// The value, if there is one.
    #[inline]
    pub fn get<T: Any>(&self, key: Key<T>) -> Option<&T> {
        let fact: &dyn Any = &**self.0.get(key.of())?;
        fact.downcast_ref()
    }

    /// The value to be changed, if there is one.
    pub fn get_mut<T: Any>(&mut self, key: Key<T>) -> Option<&mut T> {
        let fact: &mut dyn Any = &mut **self.0.get_mut(key.of())?;
        fact.downcast_mut()
    }

    /// The value to be changed, made by default if there is none.
    pub fn get_or_default<T: Any + Clone + Debug + Default + Send + Sync>(&mut self, key: Key<T>) -> &mut T {
        let fact: &mut dyn Any = &mut **self.0.get_or(key.of(), || Box::new(T::default()));
        fact.downcast_mut().unwrap_or_else(|| panic!("`{key}` has two types"))
    }

    /// Whether there is a value.
    #[inline]
    pub fn has<T: Any>(&self, key: Key<T>) -> bool {
        self.get(key).is_some()
    }

    /// Puts a value in the place of the one before.
    pub fn insert<T: Any + Clone + Debug + Send + Sync>(&mut self, key: Key<T>, value: T) {
        self.0.insert(key.of(), Box::new(value));
    }

    /// Takes the value out.
    pub fn remove<T: Any>(&mut self, key: Key<T>) -> Option<T> {
        let fact: Box<dyn Any> = self.0.remove(key.of())?;
        fact.downcast().ok().map(|value| *value)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::named::Constant;

    #[derive(Clone, Debug, Default, PartialEq)]
    struct Own(Vec<i32>);

    static OWN: Constant<Own> = Constant::new("facts/own");
    static FLAG: Constant<()> = Constant::new("facts/flag");

    #[test]
    fn values_have_the_type_of_their_key() {
        let mut facts = Facts::default();
        assert!(facts.get(*OWN).is_none() && facts.remove(*FLAG).is_none());
        facts.get_or_default(*OWN).0.push(3);
        facts.insert(*FLAG, ());
        let copy = facts.clone();
        facts.get_mut(*OWN).unwrap().0.push(4);
        assert_eq!((facts.get(*OWN), copy.get(*OWN)), (Some(&Own(vec![3, 4])), Some(&Own(vec![3]))));
        assert_eq!((facts.remove(*FLAG), facts.has(*FLAG), copy.has(*FLAG)), (Some(()), false, true));
        assert_eq!(facts.remove(*OWN), Some(Own(vec![3, 4])));
        assert!(facts.is_empty());
    }
}
