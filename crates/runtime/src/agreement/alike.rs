//! Finds objects with equal forms and equal cell descriptions, which only the camera can distinguish (VII.7).

use taskdata::load::alike::alike;

use super::both::Both;

pub fn check(both: &mut Both<'_>) {
    let cell = both.cell;
    for pair @ [_, object] in alike(&both.data) {
        let [first, name] = pair.map(|object| both.data.object_name(object));
        let parts = [first, name].map(|name| cell.part(name.as_str()).map(|part| (part.shape, part.size)));
        if let [Some(one), Some(other)] = parts
            && one != other
        {
            continue;
        }
        let origin = object.index().and_then(|index| both.store.origins().objects.get(index));
        let message = format!("{name} differs from {first} in nothing but its vision id");
        let help = "nothing but the camera can tell the two apart: is one a copy that was not finished?";
        both.warn("object.same", origin, message, help);
    }
}
