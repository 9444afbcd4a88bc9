//! Grains against closed forms and published test cases, as decks: impacts, restitution, rolling, cooling, budgets.

mod budgets;
mod cooling;
mod flowing;
mod impacts;
mod looking;
mod oblique;
mod powders;
mod restitution;
mod rolling;
mod scene;
