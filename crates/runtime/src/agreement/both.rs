use diagnostics::{At, Diagnostics, Problems, Source};
use plant::CellDescription;
use rcs_core::name::Name16;
use taskdata::{
    files::{Location, TaskData},
    load::Store,
};

/// Task data and cell description, and the findings in both.
pub struct Both<'a> {
    pub cell: &'a CellDescription,
    pub store: &'a Store,
    pub data: TaskData<'a>,
    source: &'a Source,
    in_data: Problems,
    in_cell: Problems,
}

impl<'a> Both<'a> {
    pub fn new(source: &'a Source, cell: &'a CellDescription, store: &'a Store) -> Self {
        let (in_data, in_cell) = Default::default();
        Self { cell, store, data: store.view(), source, in_data, in_cell }
    }

    pub fn report(self) -> Diagnostics {
        let in_data = Diagnostics::new(self.in_data, self.store.places(), 0, Vec::new());
        in_data.with(Diagnostics::of_file(self.in_cell, self.source))
    }

    /// True if every body of the cell is at its place in the task data.
    pub fn places_agree(&self) -> bool {
        !self.in_cell.has_errors()
    }

    /// An error of a form, with the entry of the cell description that it does not fit.
    pub fn form(&mut self, origin: &[At], index: Option<usize>, message: String, entry: &str) {
        let place = index.and_then(|index| origin.get(index)).copied().unwrap_or_default();
        let other = CellDescription::place(self.source, entry);
        let line =
            self.source.text.bytes().take(usize::try_from(other.start).unwrap_or(0)).filter(|b| *b == b'\n');
        let help =
            format!("{entry} in line {} of cell.toml disagrees: correct one of the two", line.count() + 1);
        self.in_data.error_help("cell.form", place, message, help);
    }

    pub fn warn(&mut self, code: &'static str, origin: Option<&At>, message: String, help: &str) {
        self.in_data.warning(code, origin.copied().unwrap_or_default(), message, Some(help.to_owned()));
    }

    /// An error of an entry of the cell description, with the form that it does not fit.
    pub fn entry(&mut self, entry: &str, message: String, form: At) {
        let place = CellDescription::place(self.source, entry);
        let form = self.store.places().words(form);
        let help = format!("the form in {form} disagrees: correct one of the two");
        self.in_cell.error_help("cell.place", place, format!("{entry}: {message}"), help);
    }

    pub fn location(&self, name: &str, sector: u16, object: Option<&str>) -> Option<Location> {
        let object = object.and_then(|object| Name16::new(object).ok());
        self.data
            .resolve_location(
                &Name16::new(name).ok()?,
                (sector != 0).then(|| i32::from(sector)),
                object.as_ref(),
            )
            .ok()
    }

    /// Position of the entry that gives the frame of a location: its pose, or the array's name.
    pub fn origin(&self, location: &Location) -> At {
        let origins = self.store.origins();
        let pose = self.data.locpt(location.place.locpt).and_then(|point| point.pose.index());
        let array = location.place.array.index().and_then(|index| origins.arrays.get(index));
        pose.and_then(|index| origins.poses.get(index)).or(array).copied().unwrap_or_default()
    }
}
