//! Round trips of all kinds of models.

use aseme_models::aip::{Aip, Participant};
use aseme_models::convert::{Format, Model};
use aseme_models::iac::{
    ChartKind, Dialect, Iac, IacNode, IacTransition, StateRefinement, TransitionRefinement, Variable,
};
use aseme_models::roles::{Capability, Functionality, RoleActivity, SystemRoles};
use aseme_models::sag::{Actor, ActorGoal, Sag};
use aseme_models::suc::{RoleKind, Suc, SystemRole, UseCase};
use aseme_models::{FunctionalityTable, aip, functionality, roles};
use proptest::prelude::*;
use proptest::sample::Index;
use yase::statechart::Frame;

use crate::kit::{read, whole};

/// Ordinary and unusual texts.
fn text() -> impl Strategy<Value = String> {
    prop_oneof![
        3 => "[a-z]{0,6}",
        2 => "[ a-zA-Z,.#\"\\\\\\[\\]&<>='\u{e9}ω:/-]{0,12}",
        1 => prop::sample::select(vec!["null", "a\nb\tc\r", " led", "x[2]", "START", "\"", "a # b", "b_or_c", "2", "(a|b)~", "->"]).prop_map(String::from),
    ]
}

fn name() -> impl Strategy<Value = String> {
    prop_oneof![4 => "[a-c]", 1 => text()]
}

/// Links to some of a number of objects, each at most once.
fn links(count: usize) -> impl Strategy<Value = Vec<usize>> {
    prop::collection::vec(any::<Index>(), 0..4).prop_map(move |links| {
        let mut kept: Vec<usize> = Vec::new();
        if count > 0 {
            links.iter().map(|link| link.index(count)).for_each(|link| {
                if !kept.contains(&link) {
                    kept.push(link)
                }
            });
        }
        kept
    })
}

fn sag() -> impl Strategy<Value = Model> {
    prop::collection::vec(name(), 0..4).prop_flat_map(|names| {
        let goal = (name(), text(), links(names.len()), links(names.len())).prop_map(
            |(name, requirements, depender, dependees)| ActorGoal {
                name,
                requirements,
                depender: depender.first().copied(),
                dependees,
                ..ActorGoal::default()
            },
        );
        let actors: Vec<Actor> = names.into_iter().map(|name| Actor { name, ..Actor::default() }).collect();
        prop::collection::vec(goal, 0..4)
            .prop_map(move |goals| Model::Sag(Sag { goals, actors: actors.clone() }))
    })
}

fn suc() -> impl Strategy<Value = Model> {
    let kinds = vec![
        RoleKind::Abstract,
        RoleKind::System,
        RoleKind::LegacySystem,
        RoleKind::ExternalSystem,
        RoleKind::Human,
    ];
    let role = (name(), prop::sample::select(kinds)).prop_map(|(name, kind)| SystemRole {
        name,
        kind,
        ..SystemRole::default()
    });
    (prop::collection::vec(role, 0..4), 0..4_usize).prop_flat_map(|(roles, count)| {
        let usecase = (name(), text(), links(roles.len()), links(count)).prop_map(
            |(name, specified_by, participants, includes)| UseCase {
                name,
                specified_by,
                participants,
                includes,
                ..UseCase::default()
            },
        );
        prop::collection::vec(usecase, count)
            .prop_map(move |usecases| Model::Suc(Suc { roles: roles.clone(), usecases }))
    })
}

fn protocols() -> impl Strategy<Value = Model> {
    let part = (name(), text(), text(), text()).prop_map(|(name, engaging_rules, outcomes, liveness)| {
        Participant { name, engaging_rules, outcomes, liveness, ..Participant::default() }
    });
    prop::collection::vec(part, 0..4).prop_flat_map(|participants| {
        let protocol = (name(), links(participants.len())).prop_map(|(name, participants)| aip::Protocol {
            name,
            participants,
            ..aip::Protocol::default()
        });
        prop::collection::vec(protocol, 0..3)
            .prop_map(move |protocols| Model::Aip(Aip { participants: participants.clone(), protocols }))
    })
}

fn system() -> impl Strategy<Value = Model> {
    (0..4_usize, 0..3_usize, 0..3_usize).prop_flat_map(|(activities, capabilities, functionalities)| {
        let activity = (name(), links(functionalities)).prop_map(|(name, by)| RoleActivity {
            name,
            functionality: by.first().copied(),
            ..RoleActivity::default()
        });
        let capability = (name(), links(activities), text()).prop_map(|(name, activities, description)| {
            Capability { name, activities, description, ..Capability::default() }
        });
        let role = (name(), links(activities), links(capabilities), text()).prop_map(
            |(name, activities, capabilities, liveness)| roles::Role {
                name,
                activities,
                capabilities,
                liveness,
                ..roles::Role::default()
            },
        );
        let functionality = (name(), text(), text(), text(), text()).prop_map(
            |(description, permissions, technology, environment, algorithm)| Functionality {
                permissions,
                technology,
                environment,
                description,
                algorithm,
                ..Functionality::default()
            },
        );
        (
            prop::collection::vec(activity, activities),
            prop::collection::vec(capability, capabilities),
            prop::collection::vec(role, 0..3),
            prop::collection::vec(functionality, functionalities),
        )
            .prop_map(|(activities, capabilities, roles, functionalities)| {
                Model::Srm(SystemRoles { activities, capabilities, roles, functionalities })
            })
    })
}

fn table() -> impl Strategy<Value = Model> {
    let row = (text(), text(), name(), text()).prop_map(|(role, capability, activity, functionality)| {
        functionality::FunctionalityRow {
            role,
            capability,
            activity,
            functionality,
            ..functionality::FunctionalityRow::default()
        }
    });
    prop::collection::vec(row, 0..5).prop_map(|rows| Model::Ft(FunctionalityTable { rows }))
}

type Choices = (String, String, Index, String, bool, Vec<usize>);

fn chart() -> impl Strategy<Value = Iac> {
    let kinds = prop::sample::select(vec![
        "OR",
        "AND",
        "BASIC",
        "START",
        "END",
        "CONDITION",
        "HISTORY",
        "JUNCTION",
        "odd type",
        "",
    ]);
    let node =
        (name(), kinds.prop_map(String::from), any::<Index>(), text(), prop::bool::weighted(0.8), links(2));
    let transition = (text(), any::<Index>(), any::<Index>(), prop::bool::weighted(0.8), name());
    (name(), prop::collection::vec(node, 1..12), prop::collection::vec(transition, 0..8), text()).prop_map(
        |(name, nodes, transitions, description)| {
            let mut chart = Iac { name: name.trim().into(), description, ..Iac::default() };
            chart.variables = ["v", "w"]
                .map(|name| Variable { name: name.into(), kind: "a.State.B".into(), ..Variable::default() })
                .into();
            nodes.into_iter().for_each(|node| grow(&mut chart, node));
            let count = chart.nodes.len();
            for (te, source, target, usual, name) in transitions {
                let (source, target) = (source.index(count), target.index(count));
                let usual_name = format!("{}TO{}", chart.nodes[source].name, chart.nodes[target].name);
                let te = if te == "null" { String::new() } else { te };
                chart.transitions.push(IacTransition {
                    name: if usual { usual_name } else { name },
                    te,
                    source,
                    target,
                    ..IacTransition::default()
                });
            }
            chart
        },
    )
}

/// Adds a node below the path to the last one, so that every node follows the other descendants of
/// its parent.
fn grow(chart: &mut Iac, (name, kind, parent, functionality, by_label, variables): Choices) {
    let parent = chart.nodes.len().checked_sub(1).map(|last| {
        let indices: Vec<usize> =
            std::iter::successors(Some(last), |&node| chart.nodes[node].parent).collect();
        indices[parent.index(indices.len())]
    });
    let siblings = chart.nodes.iter().filter(|node| node.parent == parent).count();
    let label = parent.map_or("0".into(), |parent| format!("{}.{}", chart.nodes[parent].label, siblings + 1));
    let functionality = if functionality == "null" { String::new() } else { functionality };
    let name = if by_label { label.clone() } else { name };
    chart.nodes.push(IacNode { name, label, kind, functionality, variables, parent, ..IacNode::default() });
}

fn there_and_back(model: &Model, format: Format) -> Result<(), TestCaseError> {
    let written = whole(model, format);
    let (again, ..) = read(&written);
    prop_assert_eq!(&again, model, "{}", written);
    Ok(())
}

fn frames() -> impl Strategy<Value = Frame> {
    let sizes = prop::option::of((0.5..1e5, 0.5..1e5));
    (prop::option::of((0.0..1e5, 0.0..=1e5)), sizes).prop_map(|(at, size)| Frame { at, size })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn models_of_every_kind(model in prop_oneof![sag(), suc(), protocols(), system()]) {
        there_and_back(&model, Format::Text)?;
        there_and_back(&model, Format::Xmi)?;
    }

    #[test]
    fn tables(model in table()) {
        there_and_back(&model, Format::Text)?;
    }

    #[test]
    fn charts_in_text(chart in chart(), inter in any::<bool>(), priority in -3..3, weight in prop::option::of(0.0..9.0), entry in text(),
                      frame in frames(), bends in prop::collection::vec((0.0..9.0, 0.0..900.0), 0..3)) {
        let mut chart = chart;
        chart.kind = if inter { ChartKind::Inter } else { ChartKind::Intra };
        chart.nodes[0].refinement = StateRefinement { priority, entry, activity: Some(String::new()), ..StateRefinement::default() };
        chart.nodes[0].frame = frame;
        for transition in &mut chart.transitions {
            transition.bends.clone_from(&bends);
            transition.refinement = TransitionRefinement { priority, weight, interrupts: inter, internal: !inter };
        }
        there_and_back(&Model::Chart(chart), Format::Text)?;
    }

    #[test]
    fn charts_in_every_dialect(chart in chart()) {
        there_and_back(&Model::Chart(chart.clone()), Format::Statechart(Dialect::Nested2018))?;
        let older = Iac { description: String::new(), ..chart };
        there_and_back(&Model::Chart(older.clone()), Format::Statechart(Dialect::Nested2012))?;
        there_and_back(&Model::Chart(older.clone()), Format::Statechart(Dialect::Flat))?;
        let mut oldest = Iac { variables: Vec::new(), ..older };
        oldest.nodes.iter_mut().for_each(|node| node.variables.clear());
        there_and_back(&Model::Chart(oldest), Format::Statechart(Dialect::MultiRoot))?;
    }

    #[test]
    fn charts_of_formulas_mean_the_same_afterwards(text in "[a-c]( [.|] [a-c]~?| \\|\\| \\([a-c] \\. \\[[a-c]\\]\\)\\+){0,4}") {
        let (formulas, _) = aseme::liveness::parse(&format!("root = {text}"));
        let (chart, findings) = aseme::liveness_to_statechart(&formulas);
        prop_assert!(findings.is_empty());
        let model = Iac::from_statechart(&chart, ChartKind::Intra);
        let (meant, findings) = model.to_statechart();
        prop_assert_eq!(findings, vec![]);
        prop_assert_eq!(aseme::to_text(&meant), aseme::to_text(&chart));
        for format in [Format::Text, Format::Statechart(Dialect::Flat), Format::Statechart(Dialect::MultiRoot)] {
            there_and_back(&Model::Chart(model.clone()), format)?;
        }
    }
}
