//! Orders that wait: which of them are worth following.

use super::Order;

/// Drops the orders that newer ones make pointless: all that came before a new scene but what is to be seen,
/// and all but the last look.
pub fn newest(mut orders: Vec<(u64, Order)>) -> Vec<(u64, Order)> {
    if let Some(load) = orders.iter().rposition(|(_, order)| matches!(order, Order::Load(_))) {
        let outlasts = |order: &Order| !matches!(order, Order::Load(_) | Order::Act(_) | Order::Stop);
        let mut at = 0;
        orders.retain(|(_, order)| {
            at += 1;
            at > load || outlasts(order)
        });
    }
    let looks = |orders: &[(u64, Order)]| orders.iter().filter(|(_, order)| matches!(order, Order::Look(_))).count();
    let mut older = looks(&orders).saturating_sub(1);
    orders.retain(|(_, order)| {
        let superseded = matches!(order, Order::Look(_)) && older > 0;
        older -= usize::from(superseded);
        !superseded
    });
    orders
}
