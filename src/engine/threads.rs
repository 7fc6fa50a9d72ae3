//! Threads, or an error where the system gives none.

use std::error::Error as _;
use std::fmt::Display;
use std::panic::resume_unwind;
use std::thread::{Builder, Scope, ScopedJoinHandle};

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::Error;

/// So many threads that work together.
///
/// # Errors
///
/// `Error::Threads`, as of `spawned`.
pub fn pool(threads: usize) -> Result<ThreadPool, Error> {
    let builder = ThreadPoolBuilder::new().num_threads(threads).start_handler(|_| take_and_free(ROOM));
    let built = builder.build();
    built.map_err(|error| refused(threads, error))
}

/// Bytes that a thread of a pool takes at once. The C library would take what its blocks lie in from the system in pieces of a page or two, while all
/// threads wait.
const ROOM: usize = 2 << 20;

/// Lets the C library have so many bytes, which it keeps for what is made later (`keep_blocks`).
pub fn take_and_free(bytes: usize) {
    if cfg!(target_env = "gnu") {
        let mut block: Vec<u8> = Vec::new();
        // Where there is no room, nothing is kept.
        let _ = block.try_reserve_exact(bytes);
        drop(std::hint::black_box(block));
    }
}

/// Starts the threads that work outside of every `pool`, one a processor, unless they are there or the caller is one of a pool.
///
/// # Errors
///
/// `Error::Threads`, as of `spawned`.
pub fn common_pool() -> Result<(), Error> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    // Where there are no threads at all the first work finds out that its caller has to do it.
    if cfg!(target_family = "wasm") || rayon::current_thread_index().is_some() {
        return Ok(());
    }
    match ThreadPoolBuilder::new().build_global() {
        // One that tells no cause: they are there.
        Err(error) if error.source().is_some() => Err(refused(threads, error)),
        _ => Ok(()),
    }
}

fn refused(threads: usize, error: impl Display) -> Error {
    Error::Threads { threads, problem: error.to_string() }
}

/// Begins `work` on a thread of its own.
///
/// # Errors
///
/// `Error::Threads` where the system gives none: its limits are on processes and on memory. `work` is dropped then, and with it the ends of
/// channels that others wait at.
pub fn spawned<'scope, T: Send + 'scope>(
    scope: &'scope Scope<'scope, '_>,
    work: impl FnOnce() -> T + Send + 'scope,
) -> Result<ScopedJoinHandle<'scope, T>, Error> {
    let begun = Builder::new().spawn_scoped(scope, work);
    begun.map_err(|error| refused(1, error))
}

/// What its work came to. A panic of one thread is one of all.
pub fn joined<T>(thread: ScopedJoinHandle<T>) -> T {
    thread.join().unwrap_or_else(|panic| resume_unwind(panic))
}
