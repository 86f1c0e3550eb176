//! Strongly connected components of a graph.

/// The strongly connected component of each node, by Tarjan's algorithm without recursion. `next`
/// lists the successors of each node.
pub(crate) fn strongly_connected_components<Step>(next: &[Vec<(usize, Step)>]) -> Vec<usize> {
    const UNVISITED: usize = usize::MAX;
    let count = next.len();
    let (mut index, mut low, mut component) =
        (vec![UNVISITED; count], vec![0; count], vec![UNVISITED; count]);
    let (mut stack, mut seen, mut found) = (Vec::new(), 0, 0);
    for root in 0..count {
        if index[root] != UNVISITED {
            continue;
        }
        let mut calls = vec![(root, 0)];
        while let Some((at, edge)) = calls.pop() {
            if edge == 0 {
                (index[at], low[at]) = (seen, seen);
                seen += 1;
                stack.push(at);
            }
            match next[at].get(edge).map(|step| step.0) {
                Some(to) => {
                    calls.push((at, edge + 1));
                    if index[to] == UNVISITED {
                        calls.push((to, 0));
                    } else if component[to] == UNVISITED {
                        low[at] = low[at].min(index[to]);
                    }
                }
                None => {
                    if low[at] == index[at] {
                        while let Some(member) = stack.pop() {
                            component[member] = found;
                            if member == at {
                                break;
                            }
                        }
                        found += 1;
                    }
                    if let Some(&(before, _)) = calls.last() {
                        low[before] = low[before].min(low[at]);
                    }
                }
            }
        }
    }
    component
}

#[cfg(test)]
mod tests {
    use super::strongly_connected_components;

    #[test]
    fn places_that_reach_each_other_are_one() {
        let next = vec![vec![(1, ())], vec![(0, ()), (2, ())], vec![(3, ())], vec![], vec![(4, ())]];
        let found = strongly_connected_components(&next);
        assert_eq!(found[0], found[1]);
        let others: std::collections::BTreeSet<usize> = found.iter().copied().collect();
        assert_eq!(others.len(), 4, "{found:?}");
    }
}
