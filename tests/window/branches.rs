//! Runs can be taken back.

use crate::driver::*;

#[test]
fn clear_run_again_and_going_on_from_earlier_are_taken_back() {
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    let (first, curves) = (red(lab(&harness), 2, [5, 4]), lab(&harness).curves()[0].rows.len());

    set_number(&mut harness, "Factor p", 2.0);
    click(&mut harness, "Run again");
    let second = red(lab(&harness), 2, [5, 4]);
    assert!(second < first);
    set_number(&mut harness, "Iteration shown", 2.0);
    click(&mut harness, "Go on from here");
    let third = red(lab(&harness), 2, [5, 4]);
    assert_eq!(lab(&harness).iteration(), 2);
    click(&mut harness, "Clear");
    assert_eq!(red(lab(&harness), 2, [5, 4]), 0.0);

    for (light, iteration) in [(third, 2), (second, 5), (first, 5)] {
        harness.key_press(egui::Key::B);
        settle(&mut harness);
        assert_eq!((red(lab(&harness), 2, [5, 4]), lab(&harness).iteration()), (light, iteration));
    }
    // What was measured comes back with it; the preset stays as edited, so the results are told to be of another.
    assert_eq!(
        (lab(&harness).curves()[0].rows.len(), lab(&harness).curves()[0].name.as_str()),
        (curves, "cascaded, p = 3")
    );
    assert!(lab(&harness).is_stale());
    harness.key_press(egui::Key::N);
    settle(&mut harness);
    assert_eq!((red(lab(&harness), 2, [5, 4]), lab(&harness).is_stale()), (second, false));
    // Its past is there too.
    set_number(&mut harness, "Iteration shown", 1.0);
    assert!(lab(&harness).shown().iter().all(|shown| shown.iteration == 1 && !shown.forgotten));
}
