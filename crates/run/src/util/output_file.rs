//! Output files, written whole or not at all: under a name of their own beside the target, forced to disk, then renamed
//! over it.
//!
//! A crash of the process or the machine leaves the file as it was before. A device or a pipe is written to as it is. A
//! symbolic link is refused: it may lead to a file that is not meant.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

use crate::{Error, Result};

/// An output file that is being written. Dropped before [`OutputFile::finish`], it leaves nothing behind.
#[derive(Debug)]
pub struct OutputFile {
    path: PathBuf,
    target: BufWriter<Target>,
}

#[derive(Debug)]
enum Target {
    Draft(NamedTempFile),
    Device(File),
}

impl OutputFile {
    /// Begins the file, and makes its folder if that does not exist.
    ///
    /// # Errors
    /// [`Error::File`] that names what cannot be written; [`Error::Content`] where it is a symbolic link to a file.
    pub fn create(path: &Path) -> Result<Self> {
        let fault = |source| Error::file(path, source);
        let folder = folder_of(path);
        fs::create_dir_all(folder).map_err(|source| Error::file(folder, source))?;
        let there = fs::metadata(path).ok();
        let target = match &there {
            Some(there) if !there.is_file() => Target::Device(File::options().write(true).open(path).map_err(fault)?),
            _ if path.is_symlink() => {
                return Err(Error::content(path, "a symbolic link; name the file itself, which is then replaced"));
            }
            _ => Target::Draft(draft(folder, there.map(|there| there.permissions())).map_err(fault)?),
        };
        Ok(Self { path: path.to_owned(), target: BufWriter::new(target) })
    }

    /// Appends bytes.
    ///
    /// # Errors
    /// [`Error::File`] that names the file.
    pub fn append(&mut self, bytes: &[u8]) -> Result<()> {
        self.target.write_all(bytes).map_err(|source| Error::file(&self.path, source))
    }

    /// Completes the file: from now on it is there, and survives a crash of the machine.
    ///
    /// # Errors
    /// [`Error::File`] that names the file.
    pub fn finish(self) -> Result<()> {
        let Self { path, target } = self;
        let fault = |source| Error::file(&path, source);
        if let Target::Draft(draft) = target.into_inner().map_err(|error| fault(error.into_error()))? {
            draft.as_file().sync_all().map_err(fault)?;
            draft.persist(&path).map_err(|error| fault(error.error))?;
            sync_folder(folder_of(&path));
        }
        Ok(())
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.target.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.target.flush()
    }
}

impl Write for Target {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        match self {
            Self::Draft(file) => file.write(bytes),
            Self::Device(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        match self {
            Self::Draft(file) => file.flush(),
            Self::Device(file) => file.flush(),
        }
    }
}

/// Writes a file that is in memory.
///
/// # Errors
/// Those of [`OutputFile`].
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut file = OutputFile::create(path)?;
    file.append(bytes)?;
    file.finish()
}

/// Checks that an output folder is not a link to another folder.
///
/// # Errors
/// [`Error::Content`] that names it.
pub fn check_is_no_link(folder: &Path) -> Result<()> {
    if folder.is_symlink() {
        return Err(Error::content(folder, "a symbolic link to a folder elsewhere, into which nothing is written"));
    }
    Ok(())
}

/// Forces the names in a folder to disk.
pub fn sync_folder(folder: &Path) {
    // Not every system can; the file is there in any case.
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
}

/// The one of these files that `path` names too. Devices such as /dev/null may be named twice.
pub fn same_file<'a>(path: &Path, files: impl IntoIterator<Item = &'a Path>) -> Option<&'a Path> {
    let is_device = path.exists() && !path.is_file();
    let real = canonical(path);
    let is_same = |file: &&Path| *file == path || real.is_some() && canonical(file) == real;
    if is_device { None } else { files.into_iter().find(is_same) }
}

/// The canonical path of a file, which need not exist yet if its folder does.
fn canonical(path: &Path) -> Option<PathBuf> {
    let in_its_folder = || Some(folder_of(path).canonicalize().ok()?.join(path.file_name()?));
    path.canonicalize().ok().or_else(in_its_folder)
}

/// The folder that a file or folder is in.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A file beside the target: only within a file system a file can be renamed.
#[cfg(unix)]
fn draft(folder: &Path, replaced: Option<fs::Permissions>) -> std::io::Result<NamedTempFile> {
    use std::os::unix::fs::PermissionsExt;
    // As for any new file the umask takes away from this; a temporary file is the owner's alone otherwise.
    let permissions = replaced.unwrap_or_else(|| fs::Permissions::from_mode(0o666));
    Builder::new().prefix(".closecall-").permissions(permissions).tempfile_in(folder)
}

#[cfg(not(unix))]
fn draft(folder: &Path, _: Option<fs::Permissions>) -> std::io::Result<NamedTempFile> {
    Builder::new().prefix(".closecall-").tempfile_in(folder)
}

#[cfg(test)]
mod tests {
    use crate::util::output_file::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names = names.by_ref().collect::<Vec<_>>();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_as_it_was_until_it_is_finished() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("page");
        for finishes in [false, true] {
            fs::write(&path, "before").unwrap();
            let mut file = OutputFile::create(&path).unwrap();
            file.append(b"after").unwrap();
            file.flush().unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), "before");
            if finishes {
                file.finish().unwrap();
            } else {
                drop(file);
            }
            assert_eq!(fs::read_to_string(&path).unwrap(), if finishes { "after" } else { "before" });
            assert_eq!(names(folder.path()), ["page"]);
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_new_file_is_readable_by_all_and_a_private_one_stays_private() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let plain = folder.path().join("plain");
        fs::write(&plain, "").unwrap();
        let mode = |name: &str| fs::metadata(folder.path().join(name)).unwrap().permissions().mode();
        write(&folder.path().join("new"), b"").unwrap();
        assert_eq!(mode("new"), mode("plain"));
        fs::set_permissions(&plain, fs::Permissions::from_mode(0o600)).unwrap();
        write(&plain, b"").unwrap();
        assert_eq!(mode("plain") & 0o777, 0o600);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_a_file_is_refused_and_a_device_is_written() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let mine = folder.path().join("mine");
        let link = folder.path().join("link");
        for is_there in [true, false] {
            if is_there {
                fs::write(&mine, "mine").unwrap();
            }
            symlink(&mine, &link).unwrap();
            assert!(write(&link, b"page").unwrap_err().to_string().contains("a symbolic link"));
            assert_eq!(fs::read_to_string(&mine).ok().as_deref(), is_there.then_some("mine"));
            fs::remove_file(&link).unwrap();
            let _ = fs::remove_file(&mine);
        }
        write(Path::new("/dev/null"), b"page").unwrap();
        let full = write(Path::new("/dev/full"), b"page");
        assert!(full.unwrap_err().to_string().contains("No space left"));
    }

    #[test]
    fn a_file_is_the_same_by_any_of_its_paths() {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log");
        fs::create_dir(&log).unwrap();
        let (one, other) = (log.join("one"), folder.path().join("log/../log/one"));
        assert_eq!(same_file(&other, [&*one]), Some(&*one));
        fs::write(&one, "").unwrap();
        assert_eq!(same_file(&other, [&*log.join("two"), &*one]), Some(&*one));
        assert_eq!(same_file(&other, [&*log.join("two")]), None);
    }
}
