//! The functionality table: for each role, by what each of its activities is done.
//!
//! The table is a view of a [`SystemRoles`](crate::SystemRoles) model, made to be read by those who plan a project.

use yase::expression::Place;

use crate::meta::{Class, Feature, Instance, Metamodel, Object, Typed, Value};

/// A functionality table.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct FunctionalityTable {
    /// Its rows, those of a role together and in it those of a capability.
    pub rows: Vec<Row>,
}

/// By what an activity is done.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Row {
    /// The role.
    pub role: String,
    /// The role's capability; empty for an activity of the role itself.
    pub capability: String,
    /// The activity.
    pub activity: String,
    /// The description of the functionality.
    pub functionality: String,
    /// What it is made with.
    pub technology: String,
    /// Where it runs.
    pub environment: String,
    /// What it may use.
    pub permissions: String,
    /// How it works.
    pub algorithm: String,
    /// Where it stands.
    pub place: Place,
}

static METAMODEL: Metamodel = Metamodel {
    word: "FT",
    root: "FTmodel",
    prefix: "FT",
    namespaces: &[],
    classes: &[Class {
        word: "Activity",
        feature: "rows",
        least: 0,
        title: 2,
        features: &[
            Feature::text("role"),
            Feature::text("capability"),
            Feature::text("activity"),
            Feature::text("functionality"),
            Feature::text("technology"),
            Feature::text("environment"),
            Feature::text("permissions"),
            Feature::text("algorithm"),
        ],
        subclasses: &[],
    }],
};

impl Row {
    /// Its cells, in order.
    pub fn cells(&self) -> [&str; 8] {
        [
            &self.role,
            &self.capability,
            &self.activity,
            &self.functionality,
            &self.technology,
            &self.environment,
            &self.permissions,
            &self.algorithm,
        ]
    }
}

impl Typed for FunctionalityTable {
    const METAMODEL: &'static Metamodel = &METAMODEL;

    fn from_instance(instance: &Instance) -> FunctionalityTable {
        let row = |object: &Object| Row {
            role: object.text(0),
            capability: object.text(1),
            activity: object.text(2),
            functionality: object.text(3),
            technology: object.text(4),
            environment: object.text(5),
            permissions: object.text(6),
            algorithm: object.text(7),
            place: object.place,
        };
        FunctionalityTable { rows: instance.of(0).iter().map(row).collect() }
    }

    fn to_instance(&self) -> Instance {
        let row = |row: &Row| Object::new(row.cells().map(|cell| Value::Text(cell.into())).into(), row.place);
        Instance { objects: vec![self.rows.iter().map(row).collect()] }
    }
}
