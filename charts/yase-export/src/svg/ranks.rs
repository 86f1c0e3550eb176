//! Assignment of the children of a composite to rows.

/// Course of a transition between children.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum EdgeCourse {
    /// From a child to itself.
    Loop,
    /// To the next row.
    Down,
    /// Over at least one row.
    Skip,
    /// To a row above.
    Back,
}

/// The row of each of `count` children and the course of each edge between them. An edge that
/// closes a cycle is a back edge; all others lead to a lower row.
pub(crate) fn ranks(count: usize, edges: &[(usize, usize)]) -> (Vec<usize>, Vec<EdgeCourse>) {
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
        _ if source == target => EdgeCourse::Loop,
        Some(1) => EdgeCourse::Down,
        Some(2..) if !is_back[index] => EdgeCourse::Skip,
        _ => EdgeCourse::Back,
    };
    let courses = edges.iter().enumerate().map(course).collect();
    (rows, courses)
}

#[derive(Clone, Copy, PartialEq)]
enum VisitState {
    New,
    Open,
    Done,
}

/// Depth-first search: the edges that close a cycle, and the children in topological order of the
/// others.
fn search(outgoing: &[Vec<usize>], edges: &[(usize, usize)]) -> (Vec<bool>, Vec<usize>) {
    let mut visits = vec![VisitState::New; outgoing.len()];
    let mut is_back = vec![false; edges.len()];
    let mut finished = Vec::new();
    for start in 0..outgoing.len() {
        let mut path = if visits[start] == VisitState::New { vec![(start, 0)] } else { vec![] };
        while let Some((child, next)) = path.pop() {
            visits[child] = VisitState::Open;
            let Some(&edge) = outgoing[child].get(next) else {
                visits[child] = VisitState::Done;
                finished.push(child);
                continue;
            };
            path.push((child, next + 1));
            let target = edges[edge].1;
            match visits[target] {
                VisitState::New => path.push((target, 0)),
                VisitState::Open => is_back[edge] = true,
                VisitState::Done => {}
            }
        }
    }
    finished.reverse();
    (is_back, finished)
}

#[cfg(test)]
mod tests {
    use super::*;
    use EdgeCourse::{Back, Down, Loop, Skip};

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
