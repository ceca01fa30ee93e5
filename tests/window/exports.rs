//! What is taken home: sizes, colours, the clipboard.

use egui::OutputCommand;
use egui_kittest::kittest::Queryable;

use crate::driver::*;

/// Chooses how exports are made, in the question for a file.
fn export_as(harness: &mut Window, entry: &str, choices: &[&str], path: &std::path::Path) {
    menu(harness, &["File", entry]);
    for choice in choices {
        harness.run_steps(2);
        click(harness, choice);
    }
    answer(harness, path, "Save to file");
}

#[test]
fn plots_and_pictures_have_the_size_and_the_colours_that_were_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    let ground = |pixels: &resvg::tiny_skia::Pixmap| pixels.pixel(3, 3).unwrap().red();
    for (size, width, height) in [
        ("One column, 85 mm", 1004, None),
        ("Two columns, 180 mm", 2126, None),
        ("Slide, 1920 × 1080", 1920, Some(1080)),
    ] {
        for (entry, name) in [("Plots as PNG…", "plots.png"), ("Grids as SVG or PNG…", "grids.png")] {
            for (colours, dark) in [("Dark", true), ("Light", false)] {
                let path = folder.path().join(format!("{width}-{colours}-{name}"));
                export_as(&mut harness, entry, &[size, colours], &path);
                let picture = resvg::tiny_skia::Pixmap::load_png(&path).unwrap();
                // A printer's dot more or less.
                assert!(picture.width().abs_diff(width) <= 3, "{path:?}: {}", picture.width());
                assert!(height.is_none_or(|height| picture.height() == height), "{path:?}");
                assert_eq!(ground(&picture) < 128, dark, "{path:?}");
            }
        }
    }
    let path = folder.path().join("own.svg");
    export_as(&mut harness, "Plots as SVG…", &["Own size"], &path);
    assert_eq!(lab(&harness).settings().plots.format.own, [1200, 1000]);
    let text = std::fs::read_to_string(&path).unwrap();
    let size = resvg::usvg::Tree::from_str(&text, &resvg::usvg::Options::default()).unwrap().size();
    assert_eq!((size.width(), size.height()), (1200.0, 1000.0));
}

#[test]
fn text_in_exported_pictures_is_never_smaller_than_six_points() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    for (i, size) in ["One column, 85 mm", "Two columns, 180 mm", "Slide, 1920 × 1080"].into_iter().enumerate() {
        for (entry, name) in [("Plots as SVG…", "plots.svg"), ("Grids as SVG or PNG…", "grids.svg")] {
            let path = folder.path().join(format!("{i}-{name}"));
            export_as(&mut harness, entry, &[size], &path);
            let text = std::fs::read_to_string(&path).unwrap();
            let document = resvg::usvg::roxmltree::Document::parse(&text).unwrap();
            // Exponents are smaller than the text that they belong to.
            let texts = document.descendants().filter(|n| n.has_tag_name("text"));
            let sizes = texts
                .filter_map(|n| n.attribute("font-size"))
                .map(|size| size.trim_end_matches("px").parse::<f64>().unwrap() * 72.0 / 96.0);
            let sizes: Vec<f64> = sizes.collect();
            let smallest = sizes.iter().copied().fold(f64::INFINITY, f64::min);
            assert!(sizes.len() > 10 && smallest >= 6.0, "{size}, {name}: {smallest} pt");
        }
    }
}

/// What a key puts on the clipboard.
fn clipboard(harness: &mut Window, key: egui::Key) -> OutputCommand {
    let modifiers = egui::Modifiers::COMMAND | egui::Modifiers::SHIFT;
    let pressed = egui::Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers };
    // The harness shows the output of its last frame only, so it gets a single one.
    harness.input_mut().events.push(pressed);
    harness.step();
    let commands = &harness.output().platform_output.commands;
    let copied = |command: &&OutputCommand| matches!(command, OutputCommand::CopyText(_) | OutputCommand::CopyImage(_));
    commands.iter().find(copied).expect("something is copied").clone()
}

#[test]
fn numbers_and_pictures_are_copied_by_key() {
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    let OutputCommand::CopyText(text) = clipboard(&mut harness, egui::Key::C) else { panic!("no text") };
    assert!(text.starts_with("iteration,metric,level,absolute_mean"));
    assert_eq!(text.lines().count(), 1 + lab(&harness).curves()[0].rows.len());
    for key in [egui::Key::P, egui::Key::G] {
        let OutputCommand::CopyImage(image) = clipboard(&mut harness, key) else { panic!("no picture") };
        assert!(image.width().abs_diff(1004) <= 3 && image.height() > 300);
        assert_eq!(image.pixels[image.width() + 1].a(), 255);
    }
    harness.get_by_label_contains("on the clipboard");
}

#[test]
fn a_run_is_saved_as_an_animation_and_as_numbered_pictures() {
    use image::AnimationDecoder;

    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    set_number(&mut harness, "Iteration shown", 3.0);
    let path = folder.path().join("run.png");
    export_as(&mut harness, "Run as animation…", &[], &path);
    let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
    let decoder = image::codecs::png::PngDecoder::new(file).unwrap();
    let frames = decoder.apng().unwrap().into_frames().collect_frames().unwrap();
    assert_eq!(frames.len(), 6);
    // Light moves from picture to picture.
    assert!(frames.windows(2).all(|pair| pair[0].buffer() != pair[1].buffer()));
    // What was seen is seen again.
    assert_eq!(lab(&harness).seen(), 3);

    export_as(&mut harness, "Run as numbered pictures…", &[], &folder.path().join("each.png"));
    for (k, frame) in frames.iter().enumerate() {
        let picture = image::open(folder.path().join(format!("each-000{k}.png"))).unwrap().to_rgba8();
        assert_eq!(picture.dimensions(), frame.buffer().dimensions());
    }
}
