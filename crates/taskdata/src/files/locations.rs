//! From the location and the sector of a command to a frame (VII.3 to VII.5, V.4.2).
//!
//! A name can be a location point, an owner, an array, or both a location point and an owner (UNIT_1: the corner of a
//! tray, and the owner of its arrays). Without a sector it means the location point. Sectors are counted in the array
//! that is assigned to the object at that owner, left to right and top to bottom as seen from the robot (VII.4).

use core::fmt;

use geometry::frame::{Frame, Vector};
use interfaces::{
    location::{LocationKind, Place, Site},
    record_number::{ArrayId, LocptId, MovtabId, ObjLocId, ObjectId, OwnerId},
};
use rcs_core::name::{Name, Name10, Name16};

use super::{
    data::TaskData,
    index::{object_key, reference_key},
    records::Array,
    reference::{RefType, Reference},
};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Location {
    pub name: Name10,        // location point or static array
    pub place: Place,        // for the look-up of grips and trajectories
    pub sector: Option<i32>, // from 1; `None`: not a sector
    pub frame: Frame,        // world, inches
}

impl Location {
    #[must_use]
    pub const fn site(&self) -> Site {
        let Place { kind, locpt, array } = self.place;
        Site { location: self.name, kind, record: locpt, array, sector: self.sector }
    }
}

/// Why a location, or a grip at it, is unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LookupError {
    /// No location point, owner or array has the name.
    UnknownLocation { name: Name16 },
    /// No object form has the name.
    UnknownObject { name: Name16 },
    /// The owner has several arrays, and only an object can select one.
    ObjectNeeded { location: Name16, sector: i32 },
    /// No object location form assigns the object to a member of the owner (VII.7.3).
    NotAssigned { object: Name16, location: Name16 },
    /// The location point has no sectors.
    NoSectors { location: Name16, sector: i32 },
    /// The array has the sectors 1 to `last`.
    SectorRange { location: Name16, array: Name10, sector: Option<i32>, last: i32 },
    /// The owner, such as UNIT, only groups locations.
    OwnerOnly { location: Name16 },
    /// No grip location form has the grip there, or anywhere with `$$$` (VII.7.5).
    NoGrip { object: Name16, grip: i32, location: Name10 },
}

impl fmt::Display for LookupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownLocation { name } => write!(f, "no location point, owner or array is named {name}"),
            Self::UnknownObject { name } => write!(f, "no object is named {name}"),
            Self::ObjectNeeded { location, sector } => {
                write!(f, "sector {sector} of {location} needs an object, which says how the tray is divided")
            }
            Self::NotAssigned { object, location } => {
                write!(f, "no object location form assigns {object} to a member of {location}")
            }
            Self::NoSectors { location, sector } => {
                write!(f, "{location} has no sectors: 0 was expected, {sector} found")
            }
            Self::SectorRange { location, array, sector, last } => {
                write!(f, "{array} at {location} has sectors 1 to {last}, ")?;
                match sector {
                    Some(sector) => write!(f, "{sector} found"),
                    None => f.write_str("none found"),
                }
            }
            Self::OwnerOnly { location } => {
                write!(f, "{location} only groups locations: name one of its members")
            }
            Self::NoGrip { object, grip, location } => {
                write!(f, "no grip location form has grip {grip} of {object} at {location} or at $$$")
            }
        }
    }
}

impl core::error::Error for LookupError {}

fn wide<const N: usize>(name: &Name<N>) -> Name16 {
    Name16::clipped(name.as_str())
}

impl<'a> TaskData<'a> {
    /// Resolves a location of a command (`"src-loc-16"`, `src-sector#` and so on, V.4.2). Errors: [`LookupError`] with
    /// the missing name, or with the valid sectors.
    pub fn resolve_location<const N: usize, const M: usize>(
        &self,
        name: &Name<N>,
        sector: Option<i32>,
        object: Option<&Name<M>>,
    ) -> Result<Location, LookupError> {
        let locpt = self.locpt_named(name);
        let owner = self.owner_named(name);
        match (locpt, owner, self.array_named(name), sector) {
            (Some(locpt), _, _, None) => self.point(locpt, name),
            (_, Some(owner), _, _) => self.at_owner(owner, name, sector, object),
            (Some(_), None, _, Some(sector)) => Err(LookupError::NoSectors { location: wide(name), sector }),
            (None, None, Some(array), _) => self.static_array(array, name, sector),
            (None, None, None, _) => Err(LookupError::UnknownLocation { name: wide(name) }),
        }
    }

    fn point<const N: usize>(&self, id: LocptId, name: &Name<N>) -> Result<Location, LookupError> {
        let locpt = self.locpt(id).ok_or(LookupError::UnknownLocation { name: wide(name) })?;
        let place = Place::point(id);
        Ok(Location { name: locpt.name, place, sector: None, frame: locpt.frame })
    }

    /// The member of an owner to which the object is assigned: a location point, or a sector of an array.
    fn at_owner<const N: usize, const M: usize>(
        &self,
        owner: OwnerId,
        name: &Name<N>,
        sector: Option<i32>,
        object: Option<&Name<M>>,
    ) -> Result<Location, LookupError> {
        let location = wide(name);
        let assigned = match (object, sector) {
            (Some(object), _) => self.assigned_member(owner, object, location)?,
            (None, None) => return Err(LookupError::OwnerOnly { location }),
            (None, Some(sector)) => {
                self.only_array(owner).ok_or(LookupError::ObjectNeeded { location, sector })?
            }
        };
        if assigned.kind == RefType::LocationPoint {
            return match sector {
                None => self.point(LocptId::new(assigned.number), name),
                Some(sector) => Err(LookupError::NoSectors { location, sector }),
            };
        }
        let array_id = ArrayId::new(assigned.number);
        let array = self.array(array_id).ok_or(LookupError::OwnerOnly { location })?;
        let base = self.tray_corner(owner).ok_or(LookupError::OwnerOnly { location })?;
        let corner = self.locpt(base).ok_or(LookupError::OwnerOnly { location })?;
        let frame = sector
            .and_then(|sector| self.sector_frame(array, &corner.frame, sector))
            .ok_or(LookupError::SectorRange { location, array: array.name, sector, last: array.sectors() })?;
        let place = Place { kind: LocationKind::Owner, locpt: base, array: array_id };
        Ok(Location { name: corner.name, place, sector, frame })
    }

    /// The first member of an owner of arrays: the location point at which they are used (VII.5).
    fn tray_corner(&self, owner: OwnerId) -> Option<LocptId> {
        let first = self.members_of(owner).first()?.member;
        (first.kind == RefType::LocationPoint).then_some(LocptId::new(first.number))
    }

    fn only_array(&self, owner: OwnerId) -> Option<Reference> {
        let mut arrays = self.members_of(owner).iter().map(|m| m.member).filter(|m| m.kind == RefType::Array);
        let only = arrays.next()?;
        arrays.next().is_none().then_some(only)
    }

    fn assigned_member<const M: usize>(
        &self,
        owner: OwnerId,
        object: &Name<M>,
        location: Name16,
    ) -> Result<Reference, LookupError> {
        let id = self.object_named(object).ok_or(LookupError::UnknownObject { name: wide(object) })?;
        self.object_locations(id)
            .find(|assigned| self.is_member(owner, *assigned))
            .ok_or(LookupError::NotAssigned { object: wide(object), location })
    }

    /// Arrays and location points in the order of the object location forms (VII.7.3).
    pub fn object_locations(&self, object: ObjectId) -> impl Iterator<Item = Reference> + use<'a> {
        let file = self.obj_locs;
        self.indexes
            .obj_locs
            .all(object_key(object))
            .iter()
            .filter_map(move |&n| Some(ObjLocId::new(n).of(file)?.assigned))
    }

    #[must_use]
    pub fn is_member(&self, owner: OwnerId, member: Reference) -> bool {
        self.indexes.members.all(reference_key(member)).contains(&owner.number())
    }

    fn static_array<const N: usize>(
        &self,
        id: ArrayId,
        name: &Name<N>,
        sector: Option<i32>,
    ) -> Result<Location, LookupError> {
        let location = wide(name);
        let array = self.array(id).ok_or(LookupError::UnknownLocation { name: location })?;
        // An array without its own pose is known only through its owners (VII.4).
        let base = self.pose(array.pose).ok_or(LookupError::UnknownLocation { name: location })?;
        let frame = sector
            .and_then(|sector| self.sector_frame(array, &base.frame, sector))
            .ok_or(LookupError::SectorRange { location, array: array.name, sector, last: array.sectors() })?;
        Ok(Location {
            name: array.name,
            place: Place { kind: LocationKind::Array, locpt: LocptId::NULL, array: id },
            sector,
            frame,
        })
    }

    /// The base with the steps to the first sector and to this one; `None` if the array does not have the sector.
    #[must_use]
    pub fn sector_frame(&self, array: &Array, base: &Frame, sector: i32) -> Option<Frame> {
        if sector < 1 || sector > array.sectors() {
            return None;
        }
        let from_zero = sector.checked_sub(1)?;
        let column = from_zero.checked_rem(array.columns)?;
        let row = from_zero.checked_div(array.columns)?;
        let repeat =
            |frame: Frame, step: MovtabId, times: i32| (0..times).fold(frame, |f, _| self.moved(&f, step));
        let first = self.moved(base, array.offset);
        Some(repeat(repeat(first, array.column_step, column), array.row_step, row))
    }

    /// The steps that lead out of the array from a sector, in inches along its axes; `None` in a direction with a
    /// neighbour. The base is that of [`sector_frame`](Self::sector_frame); columns and rows are perpendicular.
    #[must_use]
    pub fn steps_out(&self, array: &Array, base: &Frame, sector: &Frame) -> [Option<Vector>; 4] {
        let first = self.moved(base, array.offset);
        let from_first = first.rotation.inverse() * (sector.position - first.position);
        let out = |step: MovtabId, count: i32| {
            let step = self.moved(&Frame::identity(), step).position;
            // A step of zero gives NaN, for which every comparison is false.
            let steps = from_first.dot(&step) / step.dot(&step);
            let last = f64::from(count.saturating_sub(1));
            [(steps < 0.5).then_some(-step), (steps > last - 0.5).then_some(step)]
        };
        let [left, right] = out(array.column_step, array.columns);
        let [top, bottom] = out(array.row_step, array.rows);
        [left, right, top, bottom]
    }

    /// The place for a process that receives only the goal pose, not the sector (V.3.2, V.2.2). It has the array to
    /// which the object is assigned there, or else the location point. `None` for an unknown name.
    #[must_use]
    pub fn place_named<const N: usize, const M: usize>(
        &self,
        name: &Name<N>,
        object: Option<&Name<M>>,
    ) -> Option<Place> {
        let locpt = self.locpt_named(name);
        let array = self.owner_named(name).zip(object).and_then(|(owner, object)| {
            let assigned = self.assigned_member(owner, object, wide(name)).ok()?;
            (assigned.kind == RefType::Array).then_some(ArrayId::new(assigned.number))
        });
        match (locpt, array, self.array_named(name)) {
            (Some(locpt), Some(array), _) => Some(Place { kind: LocationKind::Owner, locpt, array }),
            (Some(locpt), None, _) => Some(Place::point(locpt)),
            (None, _, Some(array)) => Some(Place { kind: LocationKind::Array, locpt: LocptId::NULL, array }),
            (None, _, None) => None,
        }
    }

    /// The references with which forms can name a place, most exact first: the location point, the array on it, and
    /// the owners of either (VII.5, VII.7.5).
    pub fn aliases(&self, place: &Place) -> impl Iterator<Item = Reference> + Clone + use<'a> {
        Self::exact(place).into_iter().filter(|r| r.number != 0).chain(self.owners(place))
    }

    /// The location point, and the array on it, or number 0.
    pub(super) const fn exact(place: &Place) -> [Reference; 2] {
        [Reference::location_point(place.locpt), Reference::array(place.array)]
    }

    /// The owners of the location point, of its pose, or of a static array.
    pub(super) fn owners(&self, place: &Place) -> impl Iterator<Item = Reference> + Clone + use<'a> {
        let (data, place) = (*self, *place);
        // Owners of an array on a tray are omitted, because they include other trays with the same division.
        let array = if place.locpt.is_null() { place.array } else { ArrayId::NULL };
        // The location point's record is read only if the other owners have no entry.
        (0..3)
            .map(move |step| match step {
                0 => Reference::location_point(place.locpt),
                1 => Reference::array(array),
                _ => data.locpt(place.locpt).map_or(Reference::NONE, |l| Reference::pose(l.pose)),
            })
            .filter(|r| r.number != 0)
            .flat_map(move |r| {
                let owners = data.indexes.members.all(reference_key(r)).iter();
                owners.map(|&n| Reference::owner(OwnerId::new(n)))
            })
    }
}
