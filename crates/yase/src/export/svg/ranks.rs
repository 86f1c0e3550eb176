//! Which child of a composite stands in which row.

/// How a transition between children runs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Course {
    /// From a child to itself.
    Loop,
    /// To the next row.
    Down,
    /// Over one row or more.
    Skip,
    /// To a row above.
    Back,
}

/// The row of each of `count` children and the course of each edge between them; an edge that closes a cycle runs back, and each other
/// one leads to a lower row.
pub(super) fn ranks(count: usize, edges: &[(usize, usize)]) -> (Vec<usize>, Vec<Course>) {
    let mut outgoing: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (index, (source, _)) in edges.iter().enumerate() {
        outgoing[*source].push(index);
    }
    let (is_back, order) = search(&outgoing, edges);
    let mut rows = vec![0_usize; count];
    for source in order {
        for &edge in outgoing[source].iter().filter(|edge| !is_back[**edge]) {
            let target = edges[edge].1;
            rows[target] = rows[target].max(rows[source] + 1);
        }
    }
    let course = |(index, (source, target)): (usize, &(usize, usize))| match rows[*target]
        .checked_sub(rows[*source])
    {
        _ if source == target => Course::Loop,
        Some(1) => Course::Down,
        Some(2..) if !is_back[index] => Course::Skip,
        _ => Course::Back,
    };
    let courses = edges.iter().enumerate().map(course).collect();
    (rows, courses)
}

#[derive(Clone, Copy, PartialEq)]
enum Visit {
    New,
    Open,
    Done,
}

/// A depth-first search: which edges close a cycle, and the children in topological order of the others.
fn search(outgoing: &[Vec<usize>], edges: &[(usize, usize)]) -> (Vec<bool>, Vec<usize>) {
    let mut visits = vec![Visit::New; outgoing.len()];
    let mut is_back = vec![false; edges.len()];
    let mut finished = Vec::new();
    for start in 0..outgoing.len() {
        let mut path = if visits[start] == Visit::New { vec![(start, 0)] } else { vec![] };
        while let Some((child, next)) = path.pop() {
            visits[child] = Visit::Open;
            let Some(&edge) = outgoing[child].get(next) else {
                visits[child] = Visit::Done;
                finished.push(child);
                continue;
            };
            path.push((child, next + 1));
            let target = edges[edge].1;
            match visits[target] {
                Visit::New => path.push((target, 0)),
                Visit::Open => is_back[edge] = true,
                Visit::Done => {}
            }
        }
    }
    finished.reverse();
    (is_back, finished)
}

#[cfg(test)]
mod tests {
    use super::*;
    use Course::{Back, Down, Loop, Skip};

    #[test]
    fn a_repetition_has_a_loop_and_a_way_around() {
        // START, CONDITION, x, END of `x*`
        let (rows, courses) = ranks(4, &[(0, 1), (1, 2), (2, 2), (1, 3), (2, 3)]);
        assert_eq!(rows, [0, 1, 2, 3]);
        assert_eq!(courses, [Down, Down, Loop, Skip, Down]);
    }

    #[test]
    fn alternatives_share_a_row() {
        let (rows, courses) = ranks(5, &[(0, 1), (1, 2), (1, 3), (3, 4), (2, 4)]);
        assert_eq!(rows, [0, 1, 2, 2, 3]);
        assert!(courses.iter().all(|course| *course == Down));
    }

    #[test]
    fn cycles_run_back() {
        let (rows, courses) = ranks(3, &[(0, 1), (1, 2), (2, 1)]);
        assert_eq!(rows, [0, 1, 2]);
        assert_eq!(courses, [Down, Down, Back]);
    }
}
