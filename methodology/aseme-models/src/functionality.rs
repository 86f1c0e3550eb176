//! The functionality table (FT): for each role, the functionality that implements each of its
//! activities.
//!
//! The table is a view of a [`SystemRoles`](crate::SystemRoles) model for project planning.

use yase::expression::TextPosition;

use crate::meta::{Class, Feature, FeatureValue, Metamodel, ModelInstance, Object, TypedModel};

/// A functionality table.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct FunctionalityTable {
    /// Its rows, grouped by role and capability.
    pub rows: Vec<FunctionalityRow>,
}

/// The functionality that implements an activity.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct FunctionalityRow {
    /// The role.
    pub role: String,
    /// The role's capability; empty for an activity of the role itself.
    pub capability: String,
    /// The activity.
    pub activity: String,
    /// The description of the functionality.
    pub functionality: String,
    /// Its technology.
    pub technology: String,
    /// Its execution environment.
    pub environment: String,
    /// Its permissions.
    pub permissions: String,
    /// Its algorithm.
    pub algorithm: String,
    /// Its position in the source.
    pub position: TextPosition,
}

static METAMODEL: Metamodel = Metamodel {
    header: "FT",
    root: "FTmodel",
    prefix: "FT",
    namespaces: &[],
    classes: &[Class {
        header: "Activity",
        feature: "rows",
        min_count: 0,
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

impl FunctionalityTable {
    /// Fills the rows without a functionality with the functionality and the technology that
    /// `implemented` returns for the name of the activity.
    pub fn complete(&mut self, implemented: impl Fn(&str) -> Option<(String, String)>) {
        for row in self.rows.iter_mut().filter(|row| row.functionality.is_empty()) {
            if let Some((functionality, technology)) = implemented(&row.activity) {
                (row.functionality, row.technology) = (functionality, technology);
            }
        }
    }
}

impl FunctionalityRow {
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

impl TypedModel for FunctionalityTable {
    const METAMODEL: &'static Metamodel = &METAMODEL;

    fn from_instance(instance: &ModelInstance) -> FunctionalityTable {
        let row = |object: &Object| FunctionalityRow {
            role: object.text(0),
            capability: object.text(1),
            activity: object.text(2),
            functionality: object.text(3),
            technology: object.text(4),
            environment: object.text(5),
            permissions: object.text(6),
            algorithm: object.text(7),
            position: object.position,
        };
        FunctionalityTable { rows: instance.of(0).iter().map(row).collect() }
    }

    fn to_instance(&self) -> ModelInstance {
        let row = |row: &FunctionalityRow| {
            Object::new(row.cells().map(|cell| FeatureValue::Text(cell.into())).into(), row.position)
        };
        ModelInstance { objects: vec![self.rows.iter().map(row).collect()] }
    }
}
