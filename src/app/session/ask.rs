//! What panels ask for. A panel reads the session and returns these; the window grants them once the frame is drawn,
//! so that no panel sees a session that another has half changed.

use std::path::PathBuf;

use super::command::Command;
use super::comparison::Comparison;
use super::curves::Curves;
use super::items::Item;
use super::picture::Glass;
use super::plots::Plots;
use super::port::Port;
use super::purpose::Purpose;
use super::sight::SpaceLook;
use super::view::View;
use crate::app::worker::look::Pin;
use crate::scene::Preset;

/// Something that a panel asks for.
#[derive(Clone, Debug)]
pub enum Ask {
    /// Do what a command says, if it can be done.
    Do(Command),
    /// The preset as edited.
    Preset(Box<Preset>),
    /// How light is looked at.
    View(Box<View>),
    /// How light in space is looked at.
    Space(SpaceLook),
    /// What the plots show.
    Plots(Box<Plots>),
    /// What is put side by side.
    Comparison(Comparison),
    /// The curves of earlier runs.
    Kept(Vec<Curves>),
    /// Whether edits run again by themselves.
    Rerun(bool),
    /// Whether a graphics card iterates, where it can.
    OnCard(bool),
    /// Iterations a second while playing.
    Pace(f64),
    /// Memory for past iterations, in MiB.
    Past(usize),
    /// Have injectors where their paths have them at this time, in seconds.
    Moment(f64),
    /// Show this iteration.
    Scrub(usize),
    /// Keep a cell in sight, or none.
    Pin(Option<Pin>),
    /// Choose an object of the scene, or none.
    Select(Option<Item>),
    /// Have this injector placed by the next click in a view, or none.
    Place(Option<usize>),
    /// Choose a file.
    Choose(Purpose),
    /// Do what would lose edits, after a question where there are any.
    Leave(Next),
    /// Say this.
    Say(String),
    /// The port that is looked at.
    Port(Box<Port>),
    /// How pictures are looked at.
    Picture(Glass),
    /// Dismiss what is said.
    Dismiss,
    /// Dismiss what to look for.
    DismissGuide,
    /// Give up what truly arrives, or begin again.
    SeekTruth(bool),
    /// Call off the measurement of run time against error.
    CancelMeasurement,
    /// Delete the unsaved work that another window left.
    DiscardRecovered,
}

/// What was asked for in a frame, in order.
#[derive(Debug, Default)]
pub struct Asks(pub Vec<Ask>);

impl Asks {
    /// Asks for something.
    pub fn ask(&mut self, ask: Ask) {
        self.0.push(ask);
    }

    /// Asks for a command.
    pub fn command(&mut self, command: Command) {
        self.ask(Ask::Do(command));
    }

    /// Asks for a value where a panel has changed its copy of it.
    pub fn changed<T: PartialEq>(&mut self, before: &T, after: T, ask: impl FnOnce(T) -> Ask) {
        if *before != after {
            self.ask(ask(after));
        }
    }
}

/// What is to happen once edits are saved or given up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Next {
    /// Open a preset file.
    Open(PathBuf),
    /// Open a built-in preset.
    BuiltIn(String),
    /// Open the unsaved work that another window left.
    Recover,
    /// Close the window.
    Close,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_changed_is_asked_for() {
        let mut asks = Asks::default();
        asks.changed(&4.0, 4.0, Ask::Pace);
        asks.changed(&4.0, 5.0, Ask::Pace);
        assert!(matches!(asks.0.as_slice(), [Ask::Pace(pace)] if *pace == 5.0));
    }
}
