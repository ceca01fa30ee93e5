//! The transport of time: play, one more, loop.

use egui_kittest::kittest::Queryable;
use lpv_lab::app::Command;

use crate::driver::*;

#[test]
fn space_is_the_next_iteration_wherever_the_timeline_stands() {
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    set_number(&mut harness, "Iteration shown", 3.0);
    for seen in [4, 5] {
        harness.key_press(egui::Key::Space);
        settle(&mut harness);
        assert_eq!((lab(&harness).seen(), lab(&harness).iteration()), (seen, 5));
    }
    harness.key_press(egui::Key::Space);
    settle(&mut harness);
    assert_eq!((lab(&harness).seen(), lab(&harness).iteration()), (6, 6));
}

/// The iterations that are seen one after the other until the window rests, or so many.
fn watched(harness: &mut Window, most: usize) -> Vec<usize> {
    let mut seen = vec![lab(harness).seen()];
    for _ in 0..4000 {
        harness.step();
        if seen.last() != Some(&lab(harness).seen()) {
            seen.push(lab(harness).seen());
        }
        if lab(harness).is_idle() || seen.len() > most {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    seen
}

#[test]
fn play_replays_what_is_there_and_computes_on() {
    let mut harness = window(SMALL);
    set_number(&mut harness, "Pace", 15.0);
    for _ in 0..3 {
        click(&mut harness, "Propagate");
    }
    set_number(&mut harness, "Iteration shown", 1.0);
    harness.key_press(egui::Key::P);
    // A key takes two frames, and the first step is due at once.
    let seen = watched(&mut harness, 99);
    assert_eq!((seen[0], &seen[seen.len() - 3..]), (1, [3, 4, 5].as_slice()));
    assert_eq!(lab(&harness).iteration(), 5);
    // At the end it begins again from the start.
    harness.key_press(egui::Key::P);
    let again = watched(&mut harness, 99);
    assert_eq!(again[again.len() - 4..], [2, 3, 4, 5]);
    // The first step is due with the key again.
    assert!(again.iter().any(|k| *k <= 2), "{again:?}");
    assert_eq!(lab(&harness).iteration(), 5);
}

#[test]
fn a_loop_begins_again_until_it_is_paused() {
    let mut harness = window(SMALL);
    set_number(&mut harness, "Pace", 60.0);
    click(&mut harness, "Run all");
    click(&mut harness, Command::Loop.name());
    harness.key_press(egui::Key::P);
    let seen = watched(&mut harness, 20);
    assert!(seen.windows(2).filter(|pair| *pair == [5, 0]).count() >= 2, "{seen:?}");
    harness.key_press(egui::Key::P);
    settle(&mut harness);
    assert_eq!(lab(&harness).iteration(), 5);
}

const MOVING: &str = "(version: 1, title: \"Moving\", size: 8, injectors: [(kind: Single(cell: (2, 4, 4)), \
                      path: [(time: 1, by: (0, 0, 0)), (time: 5, by: (4, 0, 0))])])";

#[test]
fn light_that_moves_is_seen_at_the_time_that_is_chosen() {
    let mut harness = window(MOVING);
    let whole = red(lab(&harness), 0, [2, 4]);
    assert!(whole > 0.0);
    // Beside the light its mean on a coarser level is seen, an eighth of it.
    let seen = |harness: &Window, x: usize| red(lab(harness), 0, [x, 4]);
    let injected = |harness: &Window| [2, 3, 4].map(|x| Some(seen(harness, x)).filter(|c| *c > 0.3 * whole));
    assert_eq!(injected(&harness), [Some(whole), None, None]);
    // Half a second at a cell a second: the light is split over two cells.
    set_number(&mut harness, "Time of the scene", 1.5);
    assert!(lab(&harness).is_stale());
    click(&mut harness, "Run again");
    assert!(!lab(&harness).is_stale());
    assert_eq!(injected(&harness), [Some(whole / 2.0), Some(whole / 2.0), None]);
    set_number(&mut harness, "Time of the scene", 3.0);
    click(&mut harness, "Run again");
    assert_eq!(injected(&harness), [None, None, Some(whole)]);
}

#[test]
fn where_nothing_moves_there_is_no_time_to_choose() {
    assert!(window(SMALL).query_by_label("Time of the scene").is_none());
}

#[test]
fn a_descent_tells_the_level_it_has_come_down_to() {
    let mut harness = window(
        "(version: 1, title: \"Down\", size: 8, injectors: [(kind: Single(cell: (4, 4, 4)))], \
         propagation: (factor: 3.8, iterations: 2, descent: Cells))",
    );
    for said in ["(1 of 2 on level 3, 1³)", "(2 of 2 on level 3, 1³)", "(1 of 2 on level 2, 2³)"] {
        click(&mut harness, "Propagate");
        assert!(harness.query_by_label_contains(said).is_some(), "{said}");
    }
}
