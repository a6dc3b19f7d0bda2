//! Several processes that share the blocks of an ensemble: who runs which, and how what they know comes together.

use std::time::Duration;

/// What a message between processes is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tag {
    /// What all begin with, from the first rank.
    Plan,
    /// A block that is asked for, or given.
    Work,
    /// What is known of members.
    Tally,
}

/// The processes of a job, numbered from 0, and messages between them: what MPI has, and no more of it.
pub trait Ranks {
    /// The number of this process.
    fn rank(&self) -> usize;
    /// How many there are.
    fn size(&self) -> usize;
    /// Sends a message; those of one tag between two processes arrive in their order.
    fn send(&self, to: usize, tag: Tag, message: &[u8]);
    /// Takes a message that has arrived from whomever, and tells from whom; none if none has.
    fn poll(&self, tag: Tag) -> Option<(usize, Vec<u8>)>;
}

/// A process by itself.
#[derive(Clone, Copy, Debug, Default)]
pub struct Alone;

impl Ranks for Alone {
    fn rank(&self) -> usize {
        0
    }

    fn size(&self) -> usize {
        1
    }

    fn send(&self, _: usize, _: Tag, _: &[u8]) {}

    fn poll(&self, _: Tag) -> Option<(usize, Vec<u8>)> {
        None
    }
}

/// Waits for a message, without keeping a processor busy.
fn awaited(ranks: &dyn Ranks, tag: Tag) -> (usize, Vec<u8>) {
    let mut pause = Duration::from_micros(20);
    loop {
        if let Some(message) = ranks.poll(tag) {
            return message;
        }
        std::thread::sleep(pause);
        pause = (2 * pause).min(Duration::from_millis(2));
    }
}

/// The rank above this one in a tree that is as deep as the logarithm of their number: without its last binary digit.
fn above(rank: usize) -> usize {
    rank & rank.wrapping_sub(1)
}

/// The ranks below this one, the nearest first.
fn below(rank: usize, size: usize) -> impl Iterator<Item = usize> {
    let digits = if rank == 0 { usize::BITS } else { rank.trailing_zeros() };
    (0..digits).map(move |digit| rank + (1 << digit)).take_while(move |below| *below < size)
}

/// Brings a message of the first rank to all.
pub(crate) fn shared(ranks: &dyn Ranks, own: Vec<u8>) -> Vec<u8> {
    let message = if ranks.rank() == 0 { own } else { awaited(ranks, Tag::Plan).1 };
    // those with most below them first
    let mut below: Vec<usize> = below(ranks.rank(), ranks.size()).collect();
    below.reverse();
    below.into_iter().for_each(|rank| ranks.send(rank, Tag::Plan, &message));
    message
}

/// Merges what all ranks have; the first one gets it all, the others nothing.
///
/// # Errors
/// If one of them cannot be merged.
pub(crate) fn merged<T, E>(
    ranks: &dyn Ranks,
    mut own: T,
    merge: impl Fn(&mut T, &[u8]) -> Result<(), E>,
    write: impl Fn(&T) -> Vec<u8>,
) -> Result<Option<T>, E> {
    for _ in below(ranks.rank(), ranks.size()) {
        // the order makes no difference
        merge(&mut own, &awaited(ranks, Tag::Tally).1)?;
    }
    if ranks.rank() == 0 {
        return Ok(Some(own));
    }
    ranks.send(above(ranks.rank()), Tag::Tally, &write(&own));
    Ok(None)
}

/// Numbers up to a bound, each of which is handed to one rank: to the one that asks first.
///
/// The first rank hands them out beside its own work, whenever it is asked to [`serve`](Self::serve). Others ask for
/// the next one when they begin with one, so that none waits for it.
pub(crate) struct Handed<'r> {
    ranks: &'r dyn Ranks,
    /// The next one that nobody has; of the first rank.
    next: u64,
    count: u64,
    /// How many other ranks know that there are no more; of the first rank.
    told: usize,
    is_asked: bool,
}

impl<'r> Handed<'r> {
    pub(crate) fn new(ranks: &'r dyn Ranks, count: u64) -> Self {
        let mut handed = Self { ranks, next: 0, count, told: 0, is_asked: false };
        handed.ask();
        handed
    }

    fn ask(&mut self) {
        if self.ranks.rank() != 0 {
            self.ranks.send(0, Tag::Work, &[]);
            self.is_asked = true;
        }
    }

    fn take(&mut self) -> Option<u64> {
        let next = (self.next < self.count).then_some(self.next);
        self.next += u64::from(next.is_some());
        next
    }

    /// Answers those who ask.
    pub(crate) fn serve(&mut self) {
        if self.ranks.rank() != 0 {
            return;
        }
        while let Some((rank, _)) = self.ranks.poll(Tag::Work) {
            let next = self.take();
            self.told += usize::from(next.is_none());
            self.ranks.send(rank, Tag::Work, &next.unwrap_or(u64::MAX).to_le_bytes());
        }
    }

    /// How many were handed out.
    pub(crate) fn given(&self) -> u64 {
        self.next
    }

    /// The next number for this rank; none when all are handed out, of the first rank when all others know it too.
    pub(crate) fn next(&mut self) -> Option<u64> {
        if self.ranks.rank() == 0 {
            self.serve();
            let next = self.take();
            while next.is_none() && self.told + 1 < self.ranks.size() {
                std::thread::sleep(Duration::from_micros(200));
                self.serve();
            }
            return next;
        }
        if !std::mem::take(&mut self.is_asked) {
            return None;
        }
        let (_, answer) = awaited(self.ranks, Tag::Work);
        let next = answer.try_into().map(u64::from_le_bytes).ok().filter(|next| *next < self.count);
        if next.is_some() {
            self.ask();
        }
        next
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::sync::Mutex;
    use std::sync::mpsc::{Receiver, Sender, channel};

    use super::*;

    /// Threads in place of processes.
    struct Threads {
        rank: usize,
        to: Vec<Sender<(usize, Tag, Vec<u8>)>>,
        from: Receiver<(usize, Tag, Vec<u8>)>,
        kept: Mutex<Vec<(usize, Tag, Vec<u8>)>>,
    }

    impl Ranks for Threads {
        fn rank(&self) -> usize {
            self.rank
        }

        fn size(&self) -> usize {
            self.to.len()
        }

        fn send(&self, to: usize, tag: Tag, message: &[u8]) {
            self.to[to].send((self.rank, tag, message.to_vec())).expect("it is there");
        }

        fn poll(&self, tag: Tag) -> Option<(usize, Vec<u8>)> {
            let mut kept = self.kept.lock().expect("no panic");
            kept.extend(self.from.try_iter());
            let place = kept.iter().position(|(_, own, _)| *own == tag)?;
            let (rank, _, message) = kept.remove(place);
            Some((rank, message))
        }
    }

    fn on_each<T: Send>(size: usize, run: impl Fn(&dyn Ranks) -> T + Sync) -> Vec<T> {
        let (to, from): (Vec<_>, Vec<_>) = (0..size).map(|_| channel()).unzip();
        std::thread::scope(|scope| {
            let run = &run;
            let start = |(rank, from)| {
                let ranks = Threads { rank, to: to.clone(), from, kept: Mutex::default() };
                scope.spawn(move || run(&ranks))
            };
            let threads: Vec<_> = from.into_iter().enumerate().map(start).collect();
            threads.into_iter().map(|thread| thread.join().expect("no panic")).collect()
        })
    }

    #[test]
    fn each_number_is_handed_to_one_rank_and_all_is_merged() {
        for size in [1, 2, 3, 4, 7, 8, 13] {
            for count in [0, 1, 5, 100] {
                let found = on_each(size, |ranks| {
                    let plan = shared(ranks, if ranks.rank() == 0 { vec![7] } else { Vec::new() });
                    assert_eq!(plan, [7]);
                    let (mut handed, mut own) = (Handed::new(ranks, count), Vec::new());
                    while let Some(number) = handed.next() {
                        own.push(number as u8);
                        handed.serve();
                    }
                    let merge = |own: &mut Vec<u8>, other: &[u8]| {
                        own.extend(other);
                        Ok::<_, ()>(())
                    };
                    merged(ranks, own, merge, Vec::clone).expect("it cannot fail")
                });
                let mut all = found[0].clone().expect("the first rank has it all");
                all.sort_unstable();
                assert_eq!(all, (0..count as u8).collect::<Vec<_>>(), "{size} ranks");
                assert!(found[1..].iter().all(Option::is_none));
            }
        }
    }

    /// Each rank knows of 500 values of its own, at last all of 32,000; what is sent of them is bounded.
    #[test]
    fn what_ranks_receive_grows_as_the_logarithm() {
        use coadjoint::ensemble::Statistics;

        let values = |rank: usize| (0..500).map(move |k| (f64::from(k) * 0.37 + rank as f64).sin());
        for doubled in 0..=6_u32 {
            let size = 1 << doubled;
            let found = on_each(size, |ranks| {
                let (messages, bytes) = (Cell::new(0), Cell::new(0));
                let merge = |own: &mut Statistics, other: &[u8]| {
                    messages.set(messages.get() + 1);
                    bytes.set(bytes.get() + other.len());
                    own.merge(&Statistics::from_bytes(other).ok_or(())?);
                    Ok::<_, ()>(())
                };
                let own = Statistics::of(values(ranks.rank()));
                let all = merged(ranks, own, merge, Statistics::to_bytes).expect("what was sent");
                (all, messages.get(), bytes.get())
            });
            let all = Statistics::of((0..size).flat_map(values));
            assert_eq!(found[0].0.as_ref().map(Statistics::to_bytes), Some(all.to_bytes()), "{size} ranks");
            // as many buckets as are kept, each with its digits and its count
            let most = 4096 * 11 + 4096;
            assert_eq!(found[0].1, doubled, "{size} ranks");
            assert!(found.iter().all(|(_, messages, _)| *messages <= doubled), "{size} ranks");
            assert!(found[0].2 <= most * doubled as usize, "{size} ranks: {}", found[0].2);
            assert_eq!(found.iter().map(|(_, messages, _)| messages).sum::<u32>() as usize, size - 1);
        }
    }

    #[test]
    fn the_tree_is_as_deep_as_the_logarithm() {
        for size in 1..200_usize {
            for rank in 1..size {
                assert!(below(above(rank), size).any(|below| below == rank), "{rank} of {size}");
                let depth =
                    std::iter::successors(Some(rank), |rank| (*rank > 0).then(|| above(*rank))).count() - 1;
                assert!(depth as u32 <= size.next_power_of_two().trailing_zeros());
            }
            let all: usize = (0..size).map(|rank| below(rank, size).count()).sum();
            assert_eq!(all, size - 1);
        }
    }
}
