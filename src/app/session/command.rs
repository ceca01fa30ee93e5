//! Everything that can be done by a button, a menu or a key: one list that feeds all three, their
//! tooltips, the keyboard reference and the tests.

use egui::{Key, KeyboardShortcut, Modifiers};

use super::view::Workspace;

/// Something that the window can be told to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Command {
    /// Choose a preset file.
    Open,
    /// Write the preset to its file.
    Save,
    /// Write the preset to another file.
    SaveAs,
    /// Close the window.
    Quit,
    /// Take the last edit back.
    Undo,
    /// Do it again.
    Redo,
    /// Make everything dark and take over the edited scene.
    Clear,
    /// Add the scene's light to the finest level.
    Inject,
    /// Fill the coarser levels.
    Downsample,
    /// One iteration.
    Propagate,
    /// Sample the accumulated octree for every finest cell.
    Merge,
    /// The whole algorithm.
    RunAll,
    /// Run the edited scene as far as the present run has come.
    Rerun,
    /// Show iteration after iteration at a steady pace.
    Play,
    /// Begin again at the end.
    Loop,
    /// End what is being computed.
    Stop,
    /// Show the iteration before.
    Back,
    /// Show the iteration after.
    Forward,
    /// Show the first iteration.
    First,
    /// Show the present.
    Last,
    /// Go on from the iteration that is shown.
    Restart,
    /// Go back to the run that was left last.
    RunBefore,
    /// Go to the run that was last gone back from.
    RunAfter,
    /// Cut one cell further down the axis.
    SliceDown,
    /// Cut one cell further up the axis.
    SliceUp,
    /// Cut across the next axis.
    NextAxis,
    /// A finer level.
    Finer,
    /// A coarser level.
    Coarser,
    /// Another colouring of glyphs.
    NextPaint,
    /// The merged light, or back to a level.
    Merged,
    /// Zoom and pan back to the whole slice.
    WholeSlice,
    /// From the dark theme to the light one, or back.
    Theme,
    /// The workspace of light in the volume.
    ToLight,
    /// The workspace of the scene.
    ToScene,
    /// The workspace of the picture.
    ToPicture,
    /// The workspace of studies.
    ToStudy,
    /// Source, target and accumulated light.
    Grids,
    /// Several propagators side by side.
    Compare,
    /// The three-dimensional view.
    Space,
    /// The error plots.
    Errors,
    /// The light along a line of cells.
    Line,
    /// The plot of run time against error.
    RunTime,
    /// Measure that.
    Measure,
    /// Keep the error curves of this run beside those to come.
    KeepRun,
    /// Save what the plots show as CSV.
    ExportCsv,
    /// Save the plots as SVG.
    ExportSvg,
    /// Save the plots as PNG.
    ExportPng,
    /// Save what the grids show as SVG.
    ExportGrids,
    /// Save all iterations as an animation.
    ExportFilm,
    /// Save all iterations as numbered pictures.
    ExportFrames,
    /// Save what the Picture workspace shows as one sheet.
    ExportSheet,
    /// Put what the plots show on the clipboard, as a table.
    CopyCurves,
    /// Put the plots on the clipboard, as a picture.
    CopyPlots,
    /// Put what the grids show on the clipboard, as a picture.
    CopyGrids,
    /// Two pictures under a bar, or all side by side.
    SplitPicture,
    /// Radiance as a scale of colours, or as a display shows it.
    FalseColour,
    /// Refine the truth of the picture, or pause.
    RefineTruth,
    /// All commands, presets and settings by name.
    Palette,
    /// The built-in presets with their pictures.
    Gallery,
    /// Fold the scene's panel, or open it.
    FoldScene,
    /// Fold the plots, or open them.
    FoldPlots,
    /// Choose and change objects in the views.
    SelectTool,
    /// Add lights in the views.
    LightTool,
    /// Add occluders in the views.
    OccluderTool,
    /// Lay the plotted line through cells of the views.
    ProbeTool,
    /// The list of all keys.
    Keys,
}

impl Command {
    /// All of them, in the order of the keyboard reference.
    pub const ALL: [Command; 66] = [
        Command::Open,
        Command::Save,
        Command::SaveAs,
        Command::Quit,
        Command::Undo,
        Command::Redo,
        Command::Clear,
        Command::Inject,
        Command::Downsample,
        Command::Propagate,
        Command::Merge,
        Command::RunAll,
        Command::Rerun,
        Command::Play,
        Command::Loop,
        Command::Stop,
        Command::Back,
        Command::Forward,
        Command::First,
        Command::Last,
        Command::Restart,
        Command::RunBefore,
        Command::RunAfter,
        Command::SliceDown,
        Command::SliceUp,
        Command::NextAxis,
        Command::Finer,
        Command::Coarser,
        Command::Merged,
        Command::NextPaint,
        Command::WholeSlice,
        Command::ToLight,
        Command::ToScene,
        Command::ToPicture,
        Command::ToStudy,
        Command::Grids,
        Command::Compare,
        Command::Space,
        Command::Errors,
        Command::Line,
        Command::RunTime,
        Command::Measure,
        Command::KeepRun,
        Command::ExportCsv,
        Command::ExportSvg,
        Command::ExportPng,
        Command::ExportGrids,
        Command::ExportFilm,
        Command::ExportFrames,
        Command::ExportSheet,
        Command::CopyCurves,
        Command::CopyPlots,
        Command::CopyGrids,
        Command::SplitPicture,
        Command::FalseColour,
        Command::RefineTruth,
        Command::Palette,
        Command::Gallery,
        Command::FoldScene,
        Command::FoldPlots,
        Command::Theme,
        Command::SelectTool,
        Command::LightTool,
        Command::OccluderTool,
        Command::ProbeTool,
        Command::Keys,
    ];

    /// Its name on buttons and in menus; "…" where more is asked before anything happens.
    pub fn name(self) -> &'static str {
        self.words().0
    }

    /// A sentence that says what it does.
    pub fn explanation(self) -> &'static str {
        self.words().1
    }

    fn words(self) -> (&'static str, &'static str) {
        match self {
            Command::Open => ("Open…", "Open a preset file"),
            Command::Save => ("Save", "Save the preset to its file"),
            Command::SaveAs => ("Save as…", "Save the preset to another file"),
            Command::Quit => ("Quit", "Close the window"),
            Command::Undo => ("Undo", "Take the last edit back"),
            Command::Redo => ("Redo", "Do the last undone edit again"),
            Command::Clear => ("Clear", "Make everything dark, and take over the scene as edited"),
            Command::Inject => ("Inject", "Add the injectors' light to the finest level"),
            Command::Downsample => ("Downsample", "Fill every coarser level with the mean of the finer one"),
            Command::Propagate => {
                ("Propagate", "The next iteration: the one that is there, or one more on every level")
            }
            Command::Merge => ("Merge", "Sample the accumulated octree for every finest cell"),
            Command::RunAll => ("Run all", "Clear, inject, downsample, propagate as often as set, and merge"),
            Command::Rerun => ("Run again", "Run the scene as edited, as far as this run has come"),
            Command::Play => ("Play", "Replay the iterations that are there, then compute on; or pause"),
            Command::Loop => ("Loop", "Begin again when the end is reached while playing"),
            Command::Stop => ("Stop", "End the run after the iteration in progress"),
            Command::Back => ("Iteration before", "Show the iteration before this one"),
            Command::Forward => ("Iteration after", "Show the iteration after this one"),
            Command::First => ("First iteration", "Show the first iteration that is remembered"),
            Command::Last => ("Latest iteration", "Show the latest iteration, and follow it"),
            Command::Restart => ("Go on from here", "Go on from the iteration shown; the run that is left is kept"),
            Command::RunBefore => {
                ("Run before", "Take Clear, Run again or Go on from here back: the run that was left")
            }
            Command::RunAfter => ("Run after", "Go to the run that was last gone back from"),
            Command::SliceDown => ("Slice down", "Cut one cell nearer to the origin"),
            Command::SliceUp => ("Slice up", "Cut one cell farther from the origin"),
            Command::NextAxis => ("Next axis", "Cut across the next axis"),
            Command::Finer => ("Finer level", "Show the next finer level"),
            Command::Coarser => ("Coarser level", "Show the next coarser level"),
            Command::Merged => ("Merged levels", "Show the merged levels, or level 0"),
            Command::NextPaint => ("Next colouring", "Have the glyphs' colour tell something else"),
            Command::WholeSlice => ("Whole slice", "Zoom and pan back to the whole slice, or picture"),
            Command::ToLight => ("Light workspace", "How light travels: grids, space, comparison and plots"),
            Command::ToScene => ("Scene workspace", "The scene in space: mesh, lights and occluders"),
            Command::ToPicture => ("Picture workspace", "What a camera sees, and its truth"),
            Command::ToStudy => ("Study workspace", "Questions put to the light"),
            Command::Grids => ("Grids", "Source, target and accumulated light side by side"),
            Command::Compare => ("Compare", "Propagators or iterations side by side, with their difference"),
            Command::Space => ("3D", "The light in space: drag to orbit, scroll to zoom"),
            Command::Errors => ("Errors", "Error curves over the iterations"),
            Command::Line => ("Line", "Light along a line of cells: where the merged light jumps between levels"),
            Command::RunTime => ("Run time", "Run time against error, for every scheme on this scene"),
            Command::Measure => ("Measure", "Measure run time against error for every scheme on this scene"),
            Command::KeepRun => ("Keep curves", "Keep this run's error curves beside those of runs to come"),
            Command::ExportCsv => ("Curves as CSV…", "Save the numbers that the plots show as a table"),
            Command::ExportSvg => ("Plots as SVG…", "Save the plots as a vector picture"),
            Command::ExportPng => ("Plots as PNG…", "Save the plots as a picture"),
            Command::ExportGrids => ("Grids as SVG or PNG…", "Save the slices that are shown as a picture"),
            Command::ExportFilm => ("Run as animation…", "Save the slices of all iterations as an animated PNG"),
            Command::ExportFrames => ("Run as numbered pictures…", "Save the slices of each iteration as a PNG"),
            Command::ExportSheet => ("Pictures as sheet…", "Save the pictures and their truth side by side, as a PNG"),
            Command::CopyCurves => ("Copy curves", "Put the numbers that the plots show on the clipboard, as CSV"),
            Command::CopyPlots => ("Copy plots", "Put the plots on the clipboard, as a picture"),
            Command::CopyGrids => ("Copy grids", "Put the slices that are shown on the clipboard, as a picture"),
            Command::SplitPicture => ("Split picture", "Two pictures under a bar, or all side by side"),
            Command::FalseColour => ("False colour", "Radiance as a scale of colours, three powers of ten"),
            Command::RefineTruth => ("Refine the truth", "Trace more paths while you look, or pause"),
            Command::Palette => ("Commands…", "Find a command, a preset or a setting by its name"),
            Command::Gallery => ("Gallery…", "The built-in presets, with pictures and what to look for"),
            Command::FoldScene => ("Fold the scene", "Fold the panel of the scene to a strip, or open it"),
            Command::FoldPlots => ("Fold the plots", "Fold the plots to a strip, or open them"),
            Command::Theme => ("Light or dark theme", "From the dark theme to the light one, or back"),
            Command::SelectTool => ("Select", "Click a cell to pin it, an object to change it by its handles"),
            Command::LightTool => {
                ("Add light", "Click a cell of a view to add an injector there, or drag out a rectangle")
            }
            Command::OccluderTool => {
                ("Add occluder", "Click a cell of a view to add an occluder there, or drag out a block")
            }
            Command::ProbeTool => ("Probe", "Click a cell of a view to plot the light along the line through it"),
            Command::Keys => ("Keyboard reference", "All keys"),
        }
    }

    /// The workspace that it opens, if it opens one.
    pub fn workspace(self) -> Option<Workspace> {
        match self {
            Command::ToLight => Some(Workspace::Light),
            Command::ToScene => Some(Workspace::Scene),
            Command::ToPicture => Some(Workspace::Picture),
            Command::ToStudy => Some(Workspace::Study),
            _ => None,
        }
    }

    /// Its key, if it has one.
    pub fn shortcut(self) -> Option<KeyboardShortcut> {
        let plain = |key| Some(KeyboardShortcut::new(Modifiers::NONE, key));
        let with_control = |key| Some(KeyboardShortcut::new(Modifiers::COMMAND, key));
        let with_both = |key| Some(KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), key));
        match self {
            Command::Open => with_control(Key::O),
            Command::Save => with_control(Key::S),
            Command::SaveAs => with_both(Key::S),
            Command::Quit => with_control(Key::Q),
            Command::Undo => with_control(Key::Z),
            Command::Redo => with_both(Key::Z),
            Command::Clear => plain(Key::C),
            Command::Inject => plain(Key::I),
            Command::Downsample => plain(Key::D),
            Command::Propagate => plain(Key::Space),
            Command::Merge => plain(Key::M),
            Command::RunAll => plain(Key::R),
            Command::Rerun => plain(Key::F5),
            Command::Play => plain(Key::P),
            Command::Loop => plain(Key::O),
            Command::Stop => plain(Key::Escape),
            Command::Back => plain(Key::ArrowLeft),
            Command::Forward => plain(Key::ArrowRight),
            Command::First => plain(Key::Home),
            Command::Last => plain(Key::End),
            Command::Restart => plain(Key::G),
            Command::RunBefore => plain(Key::B),
            Command::RunAfter => plain(Key::N),
            Command::SliceDown => plain(Key::PageDown),
            Command::SliceUp => plain(Key::PageUp),
            Command::NextAxis => plain(Key::A),
            Command::Finer => plain(Key::Minus),
            Command::Coarser => plain(Key::Plus),
            Command::Merged => plain(Key::L),
            Command::NextPaint => plain(Key::H),
            Command::WholeSlice => plain(Key::W),
            Command::ToLight => plain(Key::Num1),
            Command::ToScene => plain(Key::Num2),
            Command::ToPicture => plain(Key::Num3),
            Command::ToStudy => plain(Key::Num4),
            Command::Grids => plain(Key::F2),
            Command::Compare => plain(Key::F3),
            Command::Space => plain(Key::F4),
            Command::Errors => plain(Key::F6),
            Command::Line => plain(Key::F7),
            Command::RunTime => plain(Key::F8),
            Command::Measure => plain(Key::T),
            Command::KeepRun => plain(Key::K),
            Command::CopyCurves => with_both(Key::C),
            Command::CopyPlots => with_both(Key::P),
            Command::CopyGrids => with_both(Key::G),
            Command::SplitPicture => plain(Key::S),
            Command::FalseColour => plain(Key::F),
            Command::RefineTruth => plain(Key::U),
            Command::ExportCsv => with_control(Key::E),
            Command::Palette => with_control(Key::P),
            Command::Gallery => with_control(Key::G),
            Command::FoldScene => plain(Key::F9),
            Command::FoldPlots => plain(Key::F10),
            Command::Theme => plain(Key::F11),
            Command::SelectTool => plain(Key::V),
            Command::LightTool => plain(Key::E),
            Command::OccluderTool => plain(Key::X),
            Command::ProbeTool => plain(Key::Q),
            Command::Keys => plain(Key::F1),
            Command::ExportSvg
            | Command::ExportPng
            | Command::ExportGrids
            | Command::ExportFilm
            | Command::ExportFrames
            | Command::ExportSheet => None,
        }
    }

    /// What the pointer is told about it: what it does, and its key.
    pub fn tooltip(self, ctx: &egui::Context) -> String {
        match self.shortcut() {
            Some(shortcut) => format!("{} ({})", self.explanation(), ctx.format_shortcut(&shortcut)),
            None => self.explanation().to_owned(),
        }
    }
}

/// The commands whose keys were pressed, of those that can be given. Keys that mean something to a text
/// field are left to it, and keys without a use to whatever else listens.
pub fn pressed(ctx: &egui::Context, can: impl Fn(Command) -> bool) -> Vec<Command> {
    let typing = ctx.egui_wants_keyboard_input();
    let mut commands: Vec<(Command, KeyboardShortcut)> =
        Command::ALL.iter().filter_map(|command| Some((*command, command.shortcut()?))).collect();
    // The longer shortcut first: Ctrl+Shift+S would be taken for Ctrl+S.
    commands.sort_by_key(|(_, shortcut)| !shortcut.modifiers.shift);
    commands.retain(|(command, shortcut)| can(*command) && !(typing && shortcut.conflicts_with_text_editing()));
    commands.retain(|(_, shortcut)| ctx.input_mut(|input| input.consume_shortcut(shortcut)));
    commands.into_iter().map(|(command, _)| command).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn names_and_keys_are_distinct() {
        let names: HashSet<&str> = Command::ALL.iter().map(|command| command.name()).collect();
        assert_eq!(names.len(), Command::ALL.len());
        let keys: Vec<KeyboardShortcut> = Command::ALL.iter().filter_map(|command| command.shortcut()).collect();
        assert_eq!(keys.iter().collect::<HashSet<_>>().len(), keys.len());
    }

    #[test]
    fn every_command_is_explained() {
        for command in Command::ALL {
            assert!(command.explanation().len() > 5 && command.explanation() != command.name(), "{command:?}");
        }
    }
}
