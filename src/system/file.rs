//! Files, taken with care: only regular ones are read and none beyond a limit; what is written is written whole or not
//! at all. Every failure is one line: the file, what is wrong, what would be right.

use std::ffi::{OsStr, OsString};
use std::fmt;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use super::text::one_line;

/// Why a file cannot be read or written. Shows as one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileError {
    /// The file.
    pub file: PathBuf,
    /// The line in it, from 1, where the fault has one.
    pub line: Option<usize>,
    /// What is wrong.
    pub what: String,
    /// What would be right.
    pub remedy: String,
}

impl FileError {
    /// A fault of `file` as a whole.
    pub fn new(file: &Path, what: impl AsRef<str>, remedy: impl AsRef<str>) -> Self {
        let (what, remedy) = (one_line(what.as_ref()), one_line(remedy.as_ref()));
        FileError { file: file.to_path_buf(), line: None, what, remedy }
    }

    /// What the system says of `file`.
    pub fn from_system(file: &Path, error: &io::Error) -> Self {
        let (what, remedy) = explain(error);
        Self::new(file, what, remedy)
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&one_line(&self.file.to_string_lossy()))?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        write!(f, ": {}; {}", self.what, self.remedy)
    }
}

impl std::error::Error for FileError {}

/// Opens a regular file of at most `limit` bytes; gives it with its length.
///
/// # Errors
/// Folders, pipes and devices are refused before they are opened, because opening a pipe waits for somebody to write.
pub fn open(path: &Path, limit: u64) -> Result<(File, u64), FileError> {
    let length = length(path)?;
    if length > limit {
        return Err(too_long(path, length, limit));
    }
    let file = File::open(path).map_err(|error| FileError::from_system(path, &error))?;
    Ok((file, length))
}

/// A regular file's contents, at most `limit` bytes of them.
///
/// # Errors
/// As [`open`], and where it cannot be read to its end.
pub fn read_bytes(path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    let (file, _) = open(path, limit)?;
    let mut bytes = Vec::new();
    // The limit again, because a file may grow while it is read.
    file.take(limit + 1).read_to_end(&mut bytes).map_err(|error| FileError::from_system(path, &error))?;
    if bytes.len() as u64 > limit { Err(too_long(path, bytes.len() as u64, limit)) } else { Ok(bytes) }
}

/// A text file's contents, at most `limit` bytes of them.
///
/// # Errors
/// As [`read_bytes`], and where it is not UTF-8.
pub fn read_text(path: &Path, limit: u64) -> Result<String, FileError> {
    String::from_utf8(read_bytes(path, limit)?).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + good.iter().filter(|byte| **byte == b'\n').count();
        let fault = FileError::new(path, "this line is not UTF-8 text", "save the file as UTF-8");
        FileError { line: Some(line), ..fault }
    })
}

/// The length of a regular file, in bytes.
///
/// # Errors
/// Where there is none.
pub fn length(path: &Path) -> Result<u64, FileError> {
    let metadata = fs::metadata(path).map_err(|error| FileError::from_system(path, &error))?;
    if metadata.is_dir() {
        return Err(FileError::new(path, "this is a folder", "name a file in it"));
    }
    if !metadata.is_file() {
        return Err(FileError::new(path, "this is a pipe or a device", "name a regular file"));
    }
    Ok(metadata.len())
}

/// How old an unfinished file is before it counts as left behind by a program that was killed: none takes that long
/// between two writes.
const LEFT_BEHIND: Duration = Duration::from_secs(60);

/// Writes a file whole or not at all; see [`write_whole_with`].
///
/// # Errors
/// Where it cannot be written; the file is then what it was before.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    write_whole_with(path, |out| out.write_all(bytes))
}

/// Writes a file whole or not at all: into a new file beside it, onto the disk, then in its place. Whoever reads it
/// sees the old one or the new one; of two programs that write it at a time the last one's stands. A link stays a link,
/// and the file keeps its permissions. What a killed program left unfinished beside it is removed. A pipe or a device
/// is written to as it is.
///
/// # Errors
/// Where it cannot be written, or `write` fails; the file is then what it was before.
pub fn write_whole_with(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), FileError> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    replace(&target, write).map_err(|error| {
        let (what, remedy) = explain(&error);
        FileError::new(path, format!("cannot be saved: {what}"), remedy)
    })
}

/// Checks that a file can be written, by making one beside it: before the work that is to fill it.
///
/// # Errors
/// Where [`write_whole_with`] would fail for any other reason than a full disk.
pub fn check_target(path: &Path) -> Result<(), FileError> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let checked = match fs::metadata(&target) {
        Ok(there) if there.is_dir() => Err(ErrorKind::IsADirectory.into()),
        Ok(there) if there.permissions().readonly() => Err(ErrorKind::PermissionDenied.into()),
        Ok(there) if !there.is_file() => Ok(()),
        _ => target.file_name().ok_or_else(|| ErrorKind::InvalidFilename.into()).and_then(|name| {
            let mut probe = unfinished_name(name, &process::id().to_string());
            probe.push(UNFINISHED);
            let probe = target.with_file_name(probe);
            File::create_new(&probe).and_then(|_| fs::remove_file(&probe))
        }),
    };
    checked.map_err(|error| {
        let (what, remedy) = explain(&error);
        FileError::new(path, format!("cannot be saved: {what}"), remedy)
    })
}

fn replace(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    /// Tells apart the files that one process writes at a time.
    static WRITTEN: AtomicU64 = AtomicU64::new(0);
    let name = path.file_name().ok_or(ErrorKind::InvalidFilename)?;
    let before = fs::metadata(path).ok();
    match &before {
        Some(old) if old.is_dir() => return Err(ErrorKind::IsADirectory.into()),
        Some(old) if old.permissions().readonly() => return Err(ErrorKind::PermissionDenied.into()),
        Some(old) if !old.is_file() => {
            return written(File::options().write(true).open(path)?, write).map(drop);
        }
        _ => {}
    }
    remove_left_behind(path, &unfinished_name(name, ""));
    let number = format!("{}-{}", process::id(), WRITTEN.fetch_add(1, Ordering::Relaxed));
    let mut temporary = unfinished_name(name, &number);
    temporary.push(UNFINISHED);
    let temporary = path.with_file_name(temporary);
    let replaced = (|| {
        let file = written(File::create_new(&temporary)?, write)?;
        if let Some(old) = before {
            file.set_permissions(old.permissions())?;
        }
        file.sync_all()?;
        fs::rename(&temporary, path)
    })();
    if replaced.is_err() {
        // The write's error is the one to tell.
        let _ = fs::remove_file(&temporary);
    }
    replaced?;
    // Makes the new name last through a power cut, where the system lets folders be synchronised.
    if let Some(folder) = path.parent().and_then(|folder| File::open(folder).ok()) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// The file once all is written to it.
fn written(file: File, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<File> {
    let mut out = BufWriter::new(file);
    write(&mut out)?;
    out.into_inner().map_err(io::IntoInnerError::into_error)
}

/// What the names of unfinished files end in.
const UNFINISHED: &str = ".new";

/// How the name of an unfinished `name` begins: `.name.number`.
fn unfinished_name(name: &OsStr, number: &str) -> OsString {
    let mut unfinished = OsString::from(".");
    unfinished.push(name);
    unfinished.push(".");
    unfinished.push(number);
    unfinished
}

/// Removes what killed programs left unfinished in a folder, whatever it was to become.
pub fn clear_up(folder: &Path) {
    remove_unfinished(folder, |name| {
        let rest = name.strip_prefix(b".")?;
        let dot = rest.iter().rposition(|byte| *byte == b'.')?;
        Some(&rest[dot + 1..])
    });
}

/// Removes the old unfinished files beside `path` whose names begin with `start`.
fn remove_left_behind(path: &Path, start: &OsStr) {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    remove_unfinished(folder, |name| name.strip_prefix(start.as_encoded_bytes()));
}

/// Removes old unfinished files from a folder. `number` takes one's name without its ending and gives the number in it,
/// or `None` where it is not to be removed. Where a file cannot be removed it stays: that must not keep anybody from
/// saving.
///
/// Files without a name (`O_TMPFILE`) would leave nothing behind until they get one, but must get one before they can
/// take another's place; so names that say whose they are remain needed, and serve everywhere.
fn remove_unfinished(folder: &Path, number: impl for<'a> Fn(&'a [u8]) -> Option<&'a [u8]>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let number = name.as_encoded_bytes().strip_suffix(UNFINISHED.as_bytes()).and_then(&number);
        let is_number =
            |text: &[u8]| !text.is_empty() && text.iter().all(|byte| byte.is_ascii_digit() || *byte == b'-');
        if !number.is_some_and(is_number) {
            continue;
        }
        let age = entry.metadata().and_then(|metadata| metadata.modified()).ok().and_then(|time| time.elapsed().ok());
        if age.is_some_and(|age| age > LEFT_BEHIND) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// What went wrong with a file and what to do.
pub fn explain(error: &io::Error) -> (String, &'static str) {
    let (what, remedy) = match error.kind() {
        ErrorKind::NotFound => ("no such file", "check the path"),
        ErrorKind::PermissionDenied => ("permission denied", "allow this user to access it"),
        ErrorKind::IsADirectory => ("this is a folder", "name a file in it"),
        ErrorKind::NotADirectory => ("a part of the path is no folder", "check the path"),
        ErrorKind::InvalidFilename => ("this is no file's name", "check the path"),
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => ("the disk is full", "make room, or write elsewhere"),
        ErrorKind::FileTooLarge => ("no file may be that long here", "raise `ulimit -f`, or write elsewhere"),
        ErrorKind::ReadOnlyFilesystem => ("the disk can only be read", "write elsewhere"),
        ErrorKind::OutOfMemory => ("there is no memory left", "close something else"),
        _ => return (error.to_string(), "check the file and its disk"),
    };
    (what.to_owned(), remedy)
}

fn too_long(path: &Path, length: u64, limit: u64) -> FileError {
    FileError::new(path, format!("{length} bytes are too many"), format!("at most {limit} are read here"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_saved_file_is_whole_and_leaves_nothing_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        for text in ["first", "second and longer", "3"] {
            write_whole(&path, text.as_bytes()).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_killed_programs_left_is_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let old = std::time::SystemTime::now() - 2 * LEFT_BEHIND;
        let kept = [".a.ron.7-0.new.txt", ".a.ron.my-own.new", ".b.ron.7-0.new", "a.ron.7-0.new", ".a.ron.8-1.new"];
        for name in kept.into_iter().chain([".a.ron.7-0.new", ".a.ron.9-12.new"]) {
            let file = File::create(at(name)).unwrap();
            // The last of those kept is being written just now.
            if name != ".a.ron.8-1.new" {
                file.set_modified(old).unwrap();
            }
        }
        write_whole(&at("a.ron"), b"text").unwrap();
        let mut left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        let mut expected: Vec<OsString> = kept.into_iter().chain(["a.ron"]).map(OsString::from).collect();
        left.sort();
        expected.sort();
        assert_eq!(left, expected);
        clear_up(folder.path());
        assert!(!at(".b.ron.7-0.new").exists() && at(".a.ron.8-1.new").exists() && at(".a.ron.my-own.new").exists());
    }

    #[test]
    fn a_save_that_fails_keeps_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("folder");
        fs::create_dir(&path).unwrap();
        let error = write_whole(&path, b"text").unwrap_err().to_string();
        assert!(error.contains("this is a folder"), "{error}");
        assert!(write_whole(&folder.path().join("no/such/folder.ron"), b"text").is_err());
        let kept = folder.path().join("kept");
        write_whole(&kept, b"before").unwrap();
        let error = write_whole_with(&kept, |out| {
            out.write_all(&[0; 100_000])?;
            Err(ErrorKind::StorageFull.into())
        });
        assert!(error.unwrap_err().to_string().contains("the disk is full; make room"));
        assert_eq!(fs::read(&kept).unwrap(), b"before");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_is_written_to_and_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("null.csv");
        std::os::unix::fs::symlink("/dev/null", &link).unwrap();
        write_whole(&link, b"text").unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }

    #[test]
    fn text_beyond_the_limit_or_not_utf8_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("text");
        fs::write(&path, b"good\nb\xffd\n").unwrap();
        let error = read_text(&path, 100).unwrap_err().to_string();
        assert!(error.contains("text:2: "), "{error}");
        let error = read_text(&path, 8).unwrap_err().to_string();
        assert!(error.contains("9 bytes") && error.contains("at most 8"), "{error}");
    }
}
